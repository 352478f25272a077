// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/self_start.hpp"

#include <algorithm>
#include <utility>

#include "common/io/procman/pmd_reader.hpp"
#include "common/process/log.hpp"

namespace clearway {
namespace {

using core::procman::Deployment;
using core::procman::Script;
using core::procman::ScriptRunner;

constexpr std::int64_t kStepUs = 50'000;

// Only what is to run here: other deputies are their own masters.
Deployment OwnPart(Deployment deployment, const std::string& deputy) {
  std::erase_if(deployment.commands,
                [&deputy](const auto& command) { return command.deputy != deputy; });
  return deployment;
}

}  // namespace

SelfStart::SelfStart(process::Runtime& runtime, DeputyProcess& deputy, const ByItselfConfig& config)
    : runtime_(runtime),
      deputy_(deputy),
      sheriff_(deputy.Report().deputy_id + ":by-itself:" + std::to_string(runtime.NewSession()),
               core::procman::Sheriff::Mode::kCommand),
      runner_(sheriff_) {
  if (config.deployment.empty()) return;
  begin_timer_ = runtime_.After(config.after_us, [this, config] { Begin(config); });
}

SelfStart::~SelfStart() {
  runtime_.Cancel(begin_timer_);
  runtime_.Cancel(step_timer_);
}

void SelfStart::Begin(const ByItselfConfig& config) {
  if (deputy_.has_orders() || !deputy_.is_established()) return;
  try {
    sheriff_.Load(OwnPart(io::ReadPmd(config.deployment), deputy_.Report().deputy_id),
                  runtime_.MonotonicUs());
  } catch (const std::exception& error) {
    deputy_.SetTrouble(error.what());
    return;
  }
  const std::vector<Script>& scripts = sheriff_.deployment().scripts;
  const auto script = std::find_if(scripts.begin(), scripts.end(), [&config](const Script& each) {
    return each.name == config.script;
  });
  if (script == scripts.end()) {
    deputy_.SetTrouble(config.deployment + ": has no script \"" + config.script + "\"");
    return;
  }
  process::LogInfo("no sheriff has spoken: running the script \"" + config.script + "\" of " +
                   config.deployment);
  const std::int64_t now_us = runtime_.MonotonicUs();
  sheriff_.OnReport(deputy_.Report(), now_us);
  runner_.Run(*script, {}, now_us);
  step_timer_ = runtime_.Every(kStepUs, [this] { Step(); });
  Step();
}

void SelfStart::Step() {
  const std::int64_t now_us = runtime_.MonotonicUs();
  const core::procman::DeputyHealth health = deputy_.Health();
  if (!health.sheriff_id.empty() && health.sheriff_id != sheriff_.id()) {
    process::LogInfo("sheriff " + health.sheriff_id + " has taken over");
    runtime_.Cancel(step_timer_);
    return;
  }
  sheriff_.OnReport(deputy_.Report(), now_us);
  sheriff_.OnHealth(health, runtime_.UtimeNow(), now_us);
  const ScriptRunner::State state = runner_.Tick(now_us);
  for (const core::procman::Orders& orders :
       sheriff_.OrdersDue(now_us, std::max<std::int64_t>(runtime_.UtimeNow(), 1))) {
    deputy_.TakeOrders(orders);
  }
  if (state != ScriptRunner::State::kRunning) Finish();
}

// What the script ordered stays in force.
void SelfStart::Finish() {
  runtime_.Cancel(step_timer_);
  if (runner_.state() == ScriptRunner::State::kDone) {
    process::LogInfo("the script \"" + runner_.script() + "\" is done");
  } else {
    deputy_.SetTrouble("the script \"" + runner_.script() + "\" ended early: " + runner_.text());
  }
}

}  // namespace clearway
