// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/core/procman/deployment.hpp"
#include "common/core/procman/orders.hpp"
#include "common/core/procman/sheriff_state.hpp"
#include "common/core/procman/sheriff_view.hpp"

namespace clearway::core::procman {

/// What one sheriff knows and wants of all deputies and commands. Knows no bus and no clock: time
/// is an argument, `now_us` of this host's monotonic clock; stamps of messages are compared only
/// with stamps of the same sender. Semantics of the reference sheriff, except that
/// - a stop that was asked for before the first report ends as Stopped;
/// - a start that was asked for while a deputy is not heard waits for its report;
/// - a command that the file moved to another deputy is stopped on the old one before it is started
///   on the new one, and only when somebody asks for a start, stop or restart of it;
/// - a deputy's health, where it tells it, refines the status.
/// Not for several threads.
class Sheriff {
 public:
  enum class Mode {
    kCommand,  ///< Gives orders.
    kObserve,  ///< Never gives any; mirrors what other sheriffs order.
  };

  /// Whom a sheriff knows.
  enum class Scope {
    kBus,   ///< All deputies that are heard: their commands are taken over, and orders go to them.
    kFile,  ///< Only those that the loaded file names: for a sheriff with deputies of its own on a
            ///< bus where others are commanded by somebody else.
  };

  /// @pre sheriff_id is not empty and no other sheriff's.
  Sheriff(std::string sheriff_id, Mode mode, Scope scope = Scope::kBus);

  [[nodiscard]] const std::string& id() const { return id_; }
  [[nodiscard]] Mode mode() const { return mode_; }
  /// An observer that takes command goes on with what the last orders it heard said.
  void SetMode(Mode mode);

  /// Takes the commands of a file; changes nothing that runs. May be called again with a newer
  /// file: what that does not hold any more stays known while a deputy in scope lists it.
  void Load(Deployment deployment, std::int64_t now_us);
  [[nodiscard]] const Deployment& deployment() const { return deployment_; }

  void OnReport(const DeputyReport& report, std::int64_t now_us);
  /// `utime` is the stamp of the message.
  void OnHealth(const DeputyHealth& health, std::int64_t utime, std::int64_t now_us);
  /// Orders on the bus; our own, looped back, are ignored.
  void OnForeignOrders(const Orders& orders, std::int64_t now_us);

  /// Each returns how many commands it is about. Throw std::logic_error in an observer.
  /// `everything` means: for Stop and Remove all that is known, also what other files brought; for
  /// Start and Restart, where a file was loaded, what that holds.
  /// Start: no-op for what runs already. Restart: also starts what does not run. With `force` a
  /// silent deputy that may still run it keeps nothing from starting elsewhere.
  int Start(const Target& target, std::int64_t now_us, bool force = false);
  int Restart(const Target& target, std::int64_t now_us, bool force = false);
  int Stop(const Target& target, std::int64_t now_us);
  /// Stops and forgets.
  int Remove(const Target& target, std::int64_t now_us);

  /// What is to be sent now: to each deputy that was heard at least once its complete orders, at
  /// 1 Hz and at once after a change. `utime` is this host's time of day; the stamps of the orders
  /// grow even where it does not. An observer gets nothing. To be called often (20 Hz) and after
  /// each call that changes something.
  [[nodiscard]] std::vector<Orders> OrdersDue(std::int64_t now_us, std::int64_t utime);
  /// All are sent again with the next call.
  void RepeatOrders();

  /// Notes what time alone changes (deputies that fall silent). OrdersDue() does it too.
  void Tick(std::int64_t now_us);

  /// Another sheriff whose orders were heard, or that a deputy obeyed, less than 3 s ago; the
  /// newest.
  [[nodiscard]] std::optional<OtherSheriff> ActiveOther(std::int64_t now_us) const;

  /// Whether the deputy has reported within the last 3 s.
  [[nodiscard]] bool IsHeard(const std::string& deputy, std::int64_t now_us) const;

  /// The commands that an action or a wait with this target is about, in the order of the snapshot.
  enum class Extent { kStart, kStop };
  [[nodiscard]] std::vector<std::string> Targeted(const Target& target, Extent extent) const;

  /// Nothing where no such command is known.
  [[nodiscard]] std::optional<CommandView> View(const std::string& command,
                                                std::int64_t now_us) const;
  [[nodiscard]] Snapshot Look(std::int64_t now_us) const;

  /// The newest kMaxHistory changes, oldest first.
  static constexpr std::size_t kMaxHistory = 2000;
  [[nodiscard]] const std::deque<Change>& history() const { return history_; }

 private:
  enum class Wish { kStart, kRestart };
  struct Judgement {
    Status status = Status::kUnknown;
    std::string text;
    /// The deputy's health is about to tell more: nothing for the history yet.
    bool is_provisional = false;
  };
  // What concerns one copy of a command: where it is, as reported, and how its deputy sees it.
  struct Copy {
    const KnownDeputy* deputy = nullptr;
    const ReportedCommand* reported = nullptr;    // Null: the deputy does not list it.
    const CommandHealthReport* health = nullptr;  // Null: not told, or older than the report.
    bool is_told = false;                         // The deputy tells health.
  };

  // sheriff.cpp
  int Act(const Target& target,
          Extent extent,
          std::int64_t now_us,
          const std::function<void(KnownCommand&)>& action);
  int Run(const Target& target, Wish wish, std::int64_t now_us, bool force);
  bool Resolve(KnownCommand& command, Wish wish);
  void MarkChanged(const KnownCommand& command);

  // sheriff_intake.cpp
  [[nodiscard]] bool IsInScope(const std::string& deputy) const;
  void TakeOver(const KnownDeputy& deputy, const ReportedCommand& reported, std::int64_t now_us);
  void TakeCommands(KnownDeputy& deputy, const DeputyReport& report, std::int64_t now_us);
  void TakeRunId(const KnownDeputy& deputy, const ReportedCommand& reported, std::int64_t now_us);
  void TakeWhatTheReportLacks(KnownDeputy& deputy, std::int64_t now_us);
  [[nodiscard]] bool IsListed(const std::string& command) const;
  void RefineByHealth(KnownDeputy& deputy, std::int64_t now_us);
  void Mirror(const DesiredCommand& desired, const KnownDeputy& deputy);
  [[nodiscard]] static bool HasTwoSenders(const KnownDeputy& deputy, std::int64_t now_us);

  // sheriff_orders.cpp
  [[nodiscard]] std::vector<DesiredCommand> WantedOf(const KnownDeputy& deputy,
                                                     std::int64_t now_us) const;
  [[nodiscard]] bool IsHeldBack(const KnownDeputy& deputy, std::int64_t now_us) const;
  [[nodiscard]] const KnownDeputy* Obstacle(const KnownCommand& command, std::int64_t now_us) const;

  // sheriff_status.cpp
  [[nodiscard]] Judgement Judge(const KnownCommand& command, std::int64_t now_us) const;
  [[nodiscard]] static Judgement JudgeCopy(const KnownCommand& command,
                                           const Copy& copy,
                                           std::int64_t now_us);
  [[nodiscard]] static Judgement JudgeEnded(const KnownCommand& command,
                                            const Copy& copy,
                                            std::int64_t now_us);
  [[nodiscard]] static Judgement JudgeRunning(const Copy& copy);
  [[nodiscard]] static Copy CopyOn(const KnownDeputy* deputy,
                                   const std::string& command,
                                   std::int64_t now_us);
  [[nodiscard]] const KnownDeputy* Elsewhere(const KnownCommand& command) const;
  [[nodiscard]] const KnownDeputy* Find(const std::string& deputy) const;
  void NoteChanges(std::int64_t now_us, std::optional<std::int64_t> utime = std::nullopt);
  void Note(Change change);

  // sheriff_look.cpp
  [[nodiscard]] CommandView ViewOf(const KnownCommand& command, std::int64_t now_us) const;
  [[nodiscard]] DeputyView ViewOf(const std::string& id, std::int64_t now_us) const;
  [[nodiscard]] std::vector<const KnownCommand*> InOrder() const;
  [[nodiscard]] static bool IsSettled(const KnownCommand& command,
                                      const Copy& copy,
                                      std::int64_t now_us);
  void AddStrays(const KnownCommand& command,
                 std::int64_t now_us,
                 std::vector<CommandView>& views) const;

  std::string id_;
  Mode mode_;
  Scope scope_;
  Deployment deployment_;
  std::map<std::string, KnownDeputy> deputies_;
  std::map<std::string, KnownCommand> commands_;
  std::map<std::string, std::int64_t> sheriffs_us_;  // Others, and when they were last heard.
  std::int64_t last_utime_ = 0;                      // Of our orders.
  std::deque<Change> history_;
  std::int64_t next_change_ = 0;
};

}  // namespace clearway::core::procman
