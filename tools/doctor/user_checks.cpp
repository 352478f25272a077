// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/user_checks.hpp"

#include <algorithm>
#include <sys/stat.h>

#include <grp.h>
#include <pwd.h>

namespace clearway::doctor {
namespace {

namespace fs = std::filesystem;

constexpr char kCheck[] = "user";

// Whose bits of the mode count for the user: those of the owner, the group or all others.
char ClassOf(const User& user, const PathPart& part) {
  if (part.uid == user.uid) return 'u';
  const bool is_in_group =
      std::find(user.groups.begin(), user.groups.end(), part.gid) != user.groups.end();
  return is_in_group ? 'g' : 'o';
}

// `bits` as of "others": 4 to read a file, 1 to pass through a folder.
bool Has(const User& user, const PathPart& part, mode_t bits) {
  if (user.uid == 0) return true;
  const char of = ClassOf(user, part);
  const unsigned shift = of == 'u' ? 6 : of == 'g' ? 3 : 0;
  return (part.mode & (bits << shift)) != 0;
}

Finding CheckFile(const FileFacts& facts, const User& user) {
  Finding finding{.check = kCheck,
                  .state = State::kProblem,
                  .text = user.name + " may not read " + facts.file.string(),
                  .mend = {}};
  if (!facts.is_there) {
    finding.text = facts.file.string() + " is not there";
    return finding;
  }
  for (const PathPart& part : facts.parts) {
    const bool is_file = &part == &facts.parts.back();
    if (Has(user, part, is_file ? 4 : 1)) continue;
    finding.mend.push_back(std::string("sudo chmod ") + ClassOf(user, part) +
                           (is_file ? "+r " : "+x ") + ShellWord(part.path.string()));
  }
  if (!finding.mend.empty()) return finding;
  return {kCheck, State::kOk, user.name + " may read " + facts.file.string(), {}};
}

}  // namespace

std::optional<User> ReadUser(const std::string& name) {
  const passwd* const entry = getpwnam(name.c_str());
  if (entry == nullptr) return std::nullopt;
  User user{name, entry->pw_uid, {}};
  const gid_t main_group = entry->pw_gid;
  int count = 0;
  getgrouplist(name.c_str(), main_group, nullptr, &count);
  user.groups.resize(static_cast<std::size_t>(std::max(count, 1)), main_group);
  count = static_cast<int>(user.groups.size());
  getgrouplist(name.c_str(), main_group, user.groups.data(), &count);
  return user;
}

FileFacts ReadFileFacts(const fs::path& file) {
  FileFacts facts{.file = file, .parts = {}, .is_there = false};
  std::error_code error;
  fs::path resolved = fs::canonical(file, error);
  if (error) resolved = fs::absolute(file);
  fs::path path;
  for (const fs::path& name : resolved) {
    path /= name;
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return facts;
    facts.parts.push_back({path, status.st_mode, status.st_uid, status.st_gid});
  }
  facts.is_there = true;
  return facts;
}

Findings CheckUser(const UserFacts& facts) {
  Findings findings;
  if (!facts.user) {
    findings.push_back({kCheck,
                        State::kNotChecked,
                        "there is no user \"" + facts.deputy_user +
                            "\" whom the deputy could run as (--user NAME)",
                        {}});
    if (facts.is_root) {
      findings.push_back({kCheck,
                          State::kWarning,
                          "started as root: a deputy that is started like this refuses to run "
                          "(it runs as the user clearway, by its service)",
                          {"sudo systemd-sysusers"}});
    }
    return findings;
  }
  for (const FileFacts& file : facts.files) findings.push_back(CheckFile(file, *facts.user));
  if (!findings.empty()) return findings;
  return {{kCheck, State::kOk, "the deputy's user \"" + facts.deputy_user + "\" is there", {}}};
}

}  // namespace clearway::doctor
