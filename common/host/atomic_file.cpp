// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/atomic_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <stdexcept>
#include <string>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

#include "common/host/descriptor.hpp"
#include "common/host/proc_file.hpp"

namespace clearway::host {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& path, const std::string& what) {
  throw std::runtime_error(WithReason(path.string() + ": " + what));
}

// A file beside the one that it becomes; gone unless it became it.
class NewFile {
 public:
  explicit NewFile(std::filesystem::path target) : target_(std::move(target)) {
    const std::string stem = target_.string() + ".new." + std::to_string(getpid()) + ".";
    constexpr int kAttempts = 1000;
    for (int i = 0; i < kAttempts && !file_.is_open(); ++i) {
      name_ = stem + std::to_string(i);
      file_.Reset(open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
      if (!file_.is_open() && errno != EEXIST) break;
    }
    if (!file_.is_open()) Fail(target_, "cannot be written");
  }
  ~NewFile() {
    if (!name_.empty()) unlink(name_.c_str());
  }
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  void TakePermissions() {
    struct stat old {};
    if (lstat(target_.c_str(), &old) != 0 || !S_ISREG(old.st_mode)) return;
    if (fchmod(file_.get(), old.st_mode & 07777U) != 0)
      Fail(target_, "cannot keep its permissions");
  }

  void Write(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t written = write(file_.get(), bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) Fail(target_, "cannot be written");
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void Publish() {
    if (fsync(file_.get()) != 0) Fail(target_, "cannot be brought to the disk");
    if (close(file_.Release()) != 0) Fail(target_, "cannot be written");
    if (rename(name_.c_str(), target_.c_str()) != 0) Fail(target_, "cannot be put in place");
    name_.clear();
  }

 private:
  std::filesystem::path target_;
  std::string name_;
  Descriptor file_;
};

// Without it a renamed file may be gone after a power cut.
void SyncFolder(const std::filesystem::path& folder) {
  const std::string name = folder.empty() ? "." : folder.string();
  const Descriptor descriptor(open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  // Some file systems have no such thing for folders and say so.
  if (!descriptor.is_open() || (fsync(descriptor.get()) != 0 && errno != EINVAL)) {
    Fail(name, "cannot be brought to the disk");
  }
}

}  // namespace

void ReplaceFile(const std::filesystem::path& path, std::string_view bytes) {
  NewFile file(path);
  file.TakePermissions();
  file.Write(bytes);
  file.Publish();
  SyncFolder(path.parent_path());
}

}  // namespace clearway::host
