// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/deputy_process.hpp"

#include <algorithm>
#include <utility>

#include "common/messages/channels.hpp"
#include "common/messages/procman.hpp"
#include "common/process/log.hpp"
#include "common/process/plain_channels.hpp"

namespace clearway {
namespace {

namespace channels = messages::channels;
using core::procman::OrdersOutcome;

constexpr std::int64_t kSecondUs = 1'000'000;
// The reference's: the deputy asks for others of its id at these times, listens for so long, and
// says who it is a little later.
constexpr std::int64_t kAnnounceUs[] = {0, 200'000, 400'000};
constexpr std::int64_t kWindowUs = 500'000;
constexpr std::int64_t kFirstInfoUs = 600'000;
// Header of PM_OUTPUT with a deputy's id of ordinary length.
constexpr std::size_t kOutputHeaderBytes = 128;
// Channels come from command lines.
constexpr std::size_t kMaxStatusChannels = 256;
// A state goes out at once, but anybody may ask for it, and many commands may change together.
constexpr PacedAction::Pace kStatePace{.interval_us = 50'000, .burst = 10};

std::size_t TextBytes(const process::Runtime& runtime, const std::string& id) {
  const std::size_t most = runtime.MaxMessageBytes(channels::kPmOutput.bus);
  const std::size_t header = kOutputHeaderBytes + id.size();
  return most > 2 * header ? most - header : header;
}

// For this program's own messages, a line each, of what may come from anywhere.
std::string OneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7F; }, '?');
  return text;
}

}  // namespace

DeputyProcess::DeputyProcess(process::Runtime& runtime,
                             DeputySettings settings,
                             Machine& machine,
                             std::function<void(int)> on_end)
    : runtime_(runtime),
      settings_(std::move(settings)),
      machine_(machine),
      on_end_(std::move(on_end)),
      deputy_(settings_.id, settings_.respawn, settings_.health, *this),
      output_(settings_.output, TextBytes(runtime, settings_.id)),
      kept_orders_(settings_.orders_file, settings_.id),
      logs_(settings_.logs),
      state_(runtime, kStatePace, [this] { PublishState(); }),
      keeping_(runtime, {}, [this] { KeepOrders(); }),
      session_(runtime.NewSession()),
      nonce_(runtime.NewSession()) {
  machine_.SetListener(this);
  const auto count_invalid = [this] { ++invalid_messages_; };
  process::Subscribe<procman_lcm::discovery_t>(
      runtime_, channels::kPmDiscover, [this](const auto& m) { OnDiscovery(m); }, count_invalid);
  process::Subscribe<procman_lcm::deputy_info_t>(
      runtime_, channels::kPmInfo, [this](const auto& m) { OnInfo(m); }, count_invalid);
  process::Subscribe<procman_lcm::orders_t>(
      runtime_, channels::kPmOrders, [this](const auto& m) { OnOrders(m); }, count_invalid);
  for (const std::int64_t delay_us : kAnnounceUs) {
    timers_.push_back(runtime_.After(delay_us, [this] { Announce(); }));
  }
  timers_.push_back(runtime_.After(kWindowUs, [this] { Establish(); }));
}

DeputyProcess::~DeputyProcess() {
  machine_.SetListener(nullptr);
  for (const auto timer : timers_) runtime_.Cancel(timer);
  if (due_timer_) runtime_.Cancel(*due_timer_);
}

void DeputyProcess::Announce() {
  if (has_ended_) return;
  procman_lcm::discovery_t message;
  message.utime = runtime_.UtimeNow();
  message.transmitter_id = settings_.id;
  message.nonce = nonce_;
  process::Publish(runtime_, channels::kPmDiscover, message);
}

void DeputyProcess::OnDiscovery(const procman_lcm::discovery_t& message) {
  if (has_ended_) return;
  if (is_established_) {
    state_.Ask();
    return;
  }
  if (message.transmitter_id != settings_.id || message.nonce == nonce_) return;
  // Of two that start together one lives. (The reference's ends whenever it hears another.)
  if (message.nonce > nonce_) return;
  process::LogError("another deputy starts with the id \"" + settings_.id +
                    "\": ids must be unique on a bus (-i)");
  End(kOtherStarts);
}

void DeputyProcess::OnInfo(const procman_lcm::deputy_info_t& message) {
  if (message.deputy_id != settings_.id || has_ended_) return;
  if (is_established_) {
    const bool is_own =
        std::find(sent_utimes_.begin(), sent_utimes_.end(), message.utime) != sent_utimes_.end();
    if (!is_own) rival_heard_us_ = runtime_.MonotonicUs();
    return;
  }
  process::LogError("another deputy runs with the id \"" + settings_.id +
                    "\": ids must be unique on a bus (-i)");
  End(kOtherRuns);
}

void DeputyProcess::Establish() {
  if (has_ended_) return;
  is_established_ = true;
  if (before_first_start_) before_first_start_();
  host_use_ = machine_.Sample();
  if (settings_.config_digest) config_digest_ = settings_.config_digest();
  Resume();
  timers_.push_back(runtime_.After(kFirstInfoUs - kWindowUs, [this] {
    EverySecond();
    timers_.push_back(runtime_.Every(kSecondUs, [this] { EverySecond(); }));
  }));
}

void DeputyProcess::OnOrders(const procman_lcm::orders_t& message) {
  if (!is_established_ || has_ended_) return;
  TakeOrders(messages::FromLcm(message));
}

OrdersOutcome DeputyProcess::TakeOrders(const core::procman::Orders& orders) {
  const std::vector<core::procman::CommandReport> before = deputy_.Reports();
  const OrdersOutcome outcome = deputy_.Take(orders, runtime_.MonotonicUs());
  if (outcome == OrdersOutcome::kStale) {
    ++stale_orders_;
    SayRarely("stale orders of " + orders.sheriff_id + " ignored: it already gave newer ones");
  } else if (outcome == OrdersOutcome::kInvalid) {
    ++invalid_messages_;
    SayRarely("orders of " + orders.sheriff_id.substr(0, core::procman::Deputy::kMaxIdBytes) +
              " ignored: an id is empty, doubled or too long, or there are too many commands");
  } else if (outcome == OrdersOutcome::kTaken) {
    keeping_.Ask();
    for (const core::procman::CommandReport& command : before) ForgetIfGone(command.spec.id);
    const std::vector<core::procman::CommandReport> after = deputy_.Reports();
    const bool has_changed = !std::equal(
        before.begin(), before.end(), after.begin(), after.end(), [](const auto& a, const auto& b) {
          return a.spec == b.spec && a.pid == b.pid && a.run_id == b.run_id;
        });
    AfterEvent(has_changed);
  }
  return outcome;
}

core::procman::StartOutcome DeputyProcess::Start(const core::procman::CommandSpec& spec) {
  core::procman::StartOutcome outcome = machine_.Start(spec);
  if (outcome.pid != 0) ids_[outcome.pid] = spec.id;
  if (!outcome.status_channel.empty() && !WatchStatus(outcome.status_channel)) {
    Note(spec.id,
         "its status is not watched: this deputy has been told of " +
             std::to_string(kMaxStatusChannels) + " other channels since its start");
  }
  return outcome;
}

bool DeputyProcess::WatchStatus(const std::string& channel) {
  if (status_channels_.contains(channel)) return true;
  if (status_channels_.size() >= kMaxStatusChannels) return false;
  const std::string& name = *status_channels_.insert(channel).first;
  process::Subscribe<status_t>(
      runtime_,
      messages::Channel<status_t>{name.c_str(), messages::BusId::kShared},
      [this, &name](const status_t& message) { OnStatus(name, message); },
      [this] { ++invalid_messages_; });
  return true;
}

void DeputyProcess::OnStatus(const std::string& channel, const status_t& message) {
  if (message.host != runtime_.HostName() || has_ended_) return;
  const std::int32_t pid = machine_.CommandPidOf(message.pid);
  if (pid == 0) return;
  const std::int64_t now_us = runtime_.MonotonicUs();
  const auto before = deputy_.Health(now_us);
  deputy_.OnStatus(channel,
                   pid,
                   {.is_fault = message.state == status_t::STATE_FAULT,
                    .is_ready = message.ready != 0,
                    .text = message.text},
                   now_us);
  const auto after = deputy_.Health(now_us);
  AfterEvent(
      !std::equal(before.begin(), before.end(), after.begin(), [](const auto& a, const auto& b) {
        return a.health == b.health;
      }));
}

void DeputyProcess::Note(const std::string& command_id, const std::string& text) {
  process::LogInfo(OneLine(command_id + ": " + text));
  logs_.WriteNote(command_id, text, runtime_.UtimeNow());
  output_.Add(command_id, "--- " + text + '\n', runtime_.MonotonicUs());
}

void DeputyProcess::OnOutput(std::int32_t pid, std::string_view text) {
  const auto id = ids_.find(pid);
  if (id == ids_.end()) return;
  logs_.Write(id->second, text, runtime_.UtimeNow());
  output_.Add(id->second, text, runtime_.MonotonicUs());
  AfterEvent(false);
}

void DeputyProcess::OnExit(std::int32_t pid, int wait_status) {
  const auto ended = ids_.extract(pid);
  deputy_.OnExit(pid, wait_status, runtime_.MonotonicUs());
  if (ended) ForgetIfGone(ended.mapped());
  keeping_.Ask();
  AfterEvent(true);
}

// Ids come and go for as long as a deputy lives: what is no command any more holds nothing.
void DeputyProcess::ForgetIfGone(const std::string& command_id) {
  if (deputy_.Knows(command_id)) return;
  logs_.Close(command_id);
  output_.Forget(command_id);
}

// What the last change asks for: news, output, the next timer, the end.
void DeputyProcess::AfterEvent(bool has_changed) {
  if (has_ended_) return;
  SendOutput();
  if (has_changed && is_established_) state_.Ask();
  if (is_shutting_down_ && deputy_.IsDone()) {
    SendOutput(settings_.output.batch_us);
    state_.Flush();
    End(kStopped);
    return;
  }
  std::optional<std::int64_t> due_us = deputy_.NextDue();
  if (const auto output_us = output_.NextDue()) {
    due_us = std::min(due_us.value_or(*output_us), *output_us);
  }
  if (due_timer_) runtime_.Cancel(*due_timer_);
  due_timer_.reset();
  if (!due_us) return;
  due_timer_ = runtime_.After(*due_us - runtime_.MonotonicUs(), [this] {
    due_timer_.reset();
    const std::int64_t now_us = runtime_.MonotonicUs();
    const bool commands_are_due = deputy_.NextDue().value_or(now_us + 1) <= now_us;
    deputy_.Tick(now_us);
    AfterEvent(commands_are_due);
  });
}

void DeputyProcess::SendOutput(std::int64_t early_us) {
  for (const core::procman::OutputQueue::Batch& batch :
       output_.Take(runtime_.MonotonicUs() + early_us)) {
    procman_lcm::output_t message;
    message.utime = runtime_.UtimeNow();
    message.deputy_id = settings_.id;
    message.num_commands = static_cast<std::int16_t>(batch.size());
    for (const auto& [id, text] : batch) {
      message.command_ids.push_back(id);
      message.text.push_back(text);
    }
    process::Publish(runtime_, channels::kPmOutput, message);
  }
}

void DeputyProcess::EverySecond() {
  if (has_ended_) return;
  host_use_ = machine_.Sample();
  if (settings_.config_digest) config_digest_ = settings_.config_digest();
  state_.Ask();
}

void DeputyProcess::SetTrouble(const std::string& text) {
  trouble_ = text;
  Say(text);
  AfterEvent(true);
}

void DeputyProcess::Say(const std::string& text) {
  process::LogWarning(OneLine(text));
  output_.Add("", text + '\n', runtime_.MonotonicUs());
}

// For what anybody on the bus can bring about as often as he likes.
void DeputyProcess::SayRarely(const std::string& text) {
  const std::int64_t now_us = runtime_.MonotonicUs();
  if (last_said_us_ >= 0 && now_us - last_said_us_ < kSecondUs) return;
  last_said_us_ = now_us;
  Say(text);
  AfterEvent(false);
}

void DeputyProcess::Resume() {
  const auto commands = kept_orders_.Read();
  if (!kept_orders_.problem().empty()) Say(kept_orders_.problem());
  if (!commands) return;
  process::LogInfo("carrying on with the last orders, " + settings_.orders_file.string());
  deputy_.Resume(*commands, runtime_.MonotonicUs());
  AfterEvent(true);
}

void DeputyProcess::KeepOrders() {
  if (is_shutting_down_) return;
  const std::string before = kept_orders_.problem();
  if (!kept_orders_.Write(deputy_.ToKeep()) && kept_orders_.problem() != before) {
    Say(kept_orders_.problem());
  }
}

void DeputyProcess::ShutDown() {
  if (!is_established_) {
    End(kStopped);
  } else if (is_shutting_down_) {
    process::LogWarning("asked to stop again: killing what is left");
    deputy_.KillAll();
  } else {
    keeping_.Flush();
    is_shutting_down_ = true;
    deputy_.ShutDown(runtime_.MonotonicUs());
    AfterEvent(true);
  }
}

void DeputyProcess::End(int status) {
  if (has_ended_) return;
  has_ended_ = true;
  on_end_(status);
}

}  // namespace clearway
