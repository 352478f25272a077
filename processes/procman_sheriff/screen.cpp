// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_sheriff/screen.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "processes/procman_sheriff/screen_log.hpp"
#include "processes/procman_sheriff/screen_messages.hpp"
#include "processes/procman_sheriff/screen_model.hpp"
#include "processes/procman_sheriff/screen_terminal.hpp"
#include "processes/procman_sheriff/screen_text.hpp"
#include "processes/procman_sheriff/verbs.hpp"

namespace clearway::screen {
namespace {

using core::procman::Change;
using core::procman::ScriptRunner;
using core::procman::Sheriff;

constexpr std::int64_t kDrawPeriodUs = 50'000;
constexpr std::int64_t kAgesPeriodUs = 1'000'000;
constexpr std::int64_t kNoticeLastsUs = 5'000'000;
// Long enough for a report and for the orders of another sheriff to come by themselves.
constexpr std::int64_t kOnePeriodUs = 1'200'000;
// A deputy tells for 3 s of orders that it obeyed: whoever gave them may be done.
constexpr std::int64_t kOthersAreForgottenUs = 4'500'000;

class Screen {
 public:
  Screen(SheriffProcess& process, process::LiveRuntime& runtime, const ScreenSettings& settings);
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;
  ~Screen();

  void Run() { runtime_.Run(); }

 private:
  // What is worth drawing at once when it changes.
  using Mark = std::tuple<ScriptRunner::State, std::string, bool, bool, bool>;

  void OnKeys();
  void OnSignal(int signal);
  void OnChange(const Change& change);
  [[nodiscard]] bool IsWorthAMark(const Change& change) const;
  void OnOutput(const CommandOutput& output);
  void OnUpdate();
  void Do(const Intent& intent);
  void Order(const Intent& intent);
  void Note(const std::string& text);
  void Invalidate();
  void Draw();
  void Take();
  void LookForOthers();
  [[nodiscard]] bool HaveAllAnswered() const;
  [[nodiscard]] ScriptProgress Progress();
  [[nodiscard]] Mark MarkNow() const;

  SheriffProcess& process_;
  process::LiveRuntime& runtime_;
  ScriptRunner::Options script_options_;
  bool is_looking_;
  std::int64_t began_us_;
  OutputStore output_;
  OutputLines messages_;
  ScreenModel model_{output_, messages_};
  ScreenLog log_;  // Before the terminal: what it has left is written when that is as it was.
  Terminal terminal_;
  process::Runtime::TimerId ages_timer_ = 0;
  std::optional<process::Runtime::TimerId> draw_timer_;
  std::int64_t drawn_us_ = 0;
  std::int64_t notice_us_ = 0;
  std::int64_t script_began_us_ = 0;
  std::int64_t script_ended_us_ = 0;
  Mark mark_;
};

Screen::Screen(SheriffProcess& process,
               process::LiveRuntime& runtime,
               const ScreenSettings& settings)
    : process_(process),
      runtime_(runtime),
      script_options_(settings.script),
      is_looking_(settings.start == ScreenStart::kCommand),
      began_us_(runtime.MonotonicUs()),
      log_(runtime, [this](const std::string& line) {
        messages_.Add(line + "\n");
        Invalidate();
      }) {
  runtime_.OnSignal([this](int signal) { OnSignal(signal); });
  runtime_.WatchDescriptor(terminal_.input(), [this] { OnKeys(); });
  ages_timer_ = runtime_.Every(kAgesPeriodUs, [this] { Invalidate(); });
  process_.OnChange([this](const Change& change) { OnChange(change); });
  process_.OnOutput([this](const CommandOutput& output) { OnOutput(output); });
  process_.OnUpdate([this] { OnUpdate(); });
  Draw();
}

Screen::~Screen() {
  process_.OnChange({});
  process_.OnOutput({});
  process_.OnUpdate({});
  runtime_.Cancel(ages_timer_);
  if (draw_timer_) runtime_.Cancel(*draw_timer_);
  runtime_.UnwatchDescriptor(terminal_.input());
  runtime_.OnSignal({});
}

void Screen::OnSignal(int signal) {
  if (signal == SIGCHLD) return;
  if (signal != SIGWINCH) return runtime_.Stop();
  terminal_.TakeSize();
  Invalidate();
}

// Orders leave within this call.
void Screen::OnKeys() {
  Take();
  for (const KeyPress& key : terminal_.ReadKeys()) {
    Do(model_.OnKey(key));
    model_.Fit(RowsOf(model_, terminal_.size()));
  }
  if (terminal_.is_gone()) runtime_.Stop();
  Invalidate();
}

void Screen::Do(const Intent& intent) {
  const std::int64_t now_us = runtime_.MonotonicUs();
  notice_us_ = now_us;
  switch (intent.kind) {
    case Intent::Kind::kNone:
      return;
    case Intent::Kind::kRedraw:
      return terminal_.Redraw();
    case Intent::Kind::kQuit:
      return runtime_.Stop();
    case Intent::Kind::kStart:
    case Intent::Kind::kStop:
    case Intent::Kind::kRestart:
      Order(intent);
      break;
    case Intent::Kind::kRunScript: {
      const auto& scripts = process_.sheriff().deployment().scripts;
      const auto found = std::find_if(scripts.begin(), scripts.end(), [&](const auto& script) {
        return script.name == intent.script;
      });
      if (found == scripts.end()) return;
      script_began_us_ = now_us;
      process_.runner().Run(*found, script_options_, now_us);
      break;
    }
    case Intent::Kind::kAbortScript:
      process_.runner().Abort();
      break;
    case Intent::Kind::kTakeCommand:
      is_looking_ = false;
      process_.sheriff().SetMode(Sheriff::Mode::kCommand);
      Note("in command now");
      break;
    case Intent::Kind::kStepBack:
      process_.runner().Abort();
      process_.sheriff().SetMode(Sheriff::Mode::kObserve);
      Note("observer now");
      break;
  }
  process_.Update();
  Take();
}

void Screen::Order(const Intent& intent) {
  Sheriff& sheriff = process_.sheriff();
  const std::int64_t now_us = runtime_.MonotonicUs();
  int commands = 0;
  if (intent.kind == Intent::Kind::kStart) {
    commands = sheriff.Start(intent.target, now_us, intent.force);
  } else if (intent.kind == Intent::Kind::kStop) {
    commands = sheriff.Stop(intent.target, now_us);
  } else {
    commands = sheriff.Restart(intent.target, now_us, intent.force);
  }
  Note(OrderInWords(intent, commands));
}

void Screen::Note(const std::string& text) {
  model_.SetNotice(text);
  messages_.AddMark(Clock(runtime_.UtimeNow()) + " " + text);
}

void Screen::OnChange(const Change& change) {
  const std::string clock = Clock(runtime_.UtimeNow());
  messages_.Add(clock + " " + ChangeInWords(change) + "\n");
  if (IsWorthAMark(change)) {
    // Between the lines of the command itself: which run wrote what.
    std::string text = "---- " + clock + " " + change.to;
    if (!change.text.empty()) text += ": " + change.text;
    output_.Of(change.command).AddMark(text);
  }
  Invalidate();
}

// A deputy of clearway itself says among a command's output how its runs begin and end.
bool Screen::IsWorthAMark(const Change& change) const {
  if (change.kind != Change::Kind::kCommand || change.to.empty()) return false;
  if (change.before == core::procman::Status::kUnknown) return false;
  const auto snapshot = process_.sheriff().Look(runtime_.MonotonicUs());
  return std::none_of(snapshot.deputies.begin(), snapshot.deputies.end(), [&](const auto& deputy) {
    return deputy.id == change.deputy && deputy.tells_health;
  });
}

void Screen::OnOutput(const CommandOutput& output) {
  if (output.command.empty()) {
    messages_.Add(Clock(runtime_.UtimeNow()) + " " + output.deputy + ": " + output.text + "\n");
  } else {
    output_.Of(output.command).Add(output.text);
  }
  Invalidate();
}

// Two that give orders would undo each other's.
void Screen::LookForOthers() {
  const std::int64_t elapsed_us = runtime_.MonotonicUs() - began_us_;
  if (elapsed_us < kOnePeriodUs && !HaveAllAnswered()) return;
  const auto other = process_.sheriff().ActiveOther(runtime_.MonotonicUs());
  if (!other || HasSheriffEnded(other->id, runtime_.HostName())) {
    is_looking_ = false;
    process_.sheriff().SetMode(Sheriff::Mode::kCommand);
  } else if (elapsed_us >= kOthersAreForgottenUs) {
    is_looking_ = false;
    Note("sheriff " + other->id + " is in command: this one observes; c takes command");
  }
}

bool Screen::HaveAllAnswered() const {
  const auto snapshot = process_.sheriff().Look(runtime_.MonotonicUs());
  return !snapshot.file.empty() &&
         std::all_of(snapshot.deputies.begin(), snapshot.deputies.end(), [](const auto& deputy) {
           return deputy.is_heard && deputy.tells_health;
         });
}

void Screen::OnUpdate() {
  if (is_looking_) LookForOthers();
  if (Mark mark = MarkNow(); mark != mark_) {
    mark_ = std::move(mark);
    Invalidate();
  }
  if (!model_.notice().empty() && runtime_.MonotonicUs() - notice_us_ > kNoticeLastsUs) {
    model_.SetNotice("");
    Invalidate();
  }
}

Screen::Mark Screen::MarkNow() const {
  const auto other = process_.sheriff().ActiveOther(runtime_.MonotonicUs());
  return {process_.runner().state(),
          process_.runner().text(),
          other.has_value(),
          process_.sheriff().mode() == Sheriff::Mode::kObserve,
          runtime_.IsConnected()};
}

void Screen::Invalidate() {
  if (draw_timer_) return;
  const std::int64_t wait_us = drawn_us_ + kDrawPeriodUs - runtime_.MonotonicUs();
  draw_timer_ = runtime_.After(wait_us, [this] {
    draw_timer_.reset();
    Draw();
  });
}

void Screen::Draw() {
  drawn_us_ = runtime_.MonotonicUs();
  if (!terminal_.IsReady()) return Invalidate();
  Take();
  model_.Fit(RowsOf(model_, terminal_.size()));
  terminal_.Draw(Compose(model_, terminal_.size(), Clock(runtime_.UtimeNow())));
  if (!terminal_.IsReady()) Invalidate();
}

void Screen::Take() {
  model_.Take({.snapshot = process_.sheriff().Look(runtime_.MonotonicUs()),
               .scripts = process_.sheriff().deployment().scripts,
               .progress = Progress(),
               .is_looking = is_looking_});
}

ScriptProgress Screen::Progress() {
  const ScriptRunner& runner = process_.runner();
  if (runner.state() == ScriptRunner::State::kRunning) script_ended_us_ = runtime_.MonotonicUs();
  return {.state = runner.state(),
          .script = runner.script(),
          .text = runner.text(),
          .awaited = runner.awaited(),
          .elapsed_us = std::max<std::int64_t>(script_ended_us_ - script_began_us_, 0)};
}

}  // namespace

int RunScreen(SheriffProcess& process,
              process::LiveRuntime& runtime,
              const ScreenSettings& settings) {
  Screen(process, runtime, settings).Run();
  const auto snapshot = process.sheriff().Look(runtime.MonotonicUs());
  const int up = snapshot.groups.empty() ? 0 : snapshot.groups.front().up;
  std::printf("clearway-sheriff: left; %d of %d commands go on running\n",
              up,
              snapshot.groups.empty() ? 0 : snapshot.groups.front().commands);
  std::fflush(stdout);
  return 0;
}

}  // namespace clearway::screen
