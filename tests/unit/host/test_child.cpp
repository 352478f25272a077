// SPDX-License-Identifier: BSD-3-Clause
// What the tests of clearway::host start as a child.

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "common/host/child_process.hpp"
#include "common/host/terminal_child.hpp"

namespace {

// Not for ever, should the test have crashed.
[[noreturn]] void WaitSilently() {
  alarm(120);
  while (true) pause();
}

[[noreturn]] void Wait() {
  std::cout << "ready" << std::endl;
  WaitSilently();
}

void SayTerminal() {
  const bool all = isatty(0) == 1 && isatty(1) == 1 && isatty(2) == 1;
  std::cout << "terminals " << all << " session " << (getsid(0) == getpid()) << " group "
            << (getpgrp() == getpid()) << " foreground " << (tcgetpgrp(0) == getpid()) << '\n';
}

// All but the one that looks for them.
void SayDescriptors() {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code error;
    const auto target = std::filesystem::read_symlink(entry.path(), error);
    if (target.string().find("/fd") == std::string::npos) ++count;
  }
  std::cout << count << '\n';
}

void SaySignals() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("SigBlk") || line.starts_with("SigIgn")) std::cout << line << '\n';
  }
}

void SayEnvironment() {
  for (char** variable = environ; *variable != nullptr; ++variable) std::cout << *variable << '\n';
}

// All byte values, and no period that a buffer's size divides.
void Flood(std::size_t bytes) {
  std::array<char, 8191> block{};
  for (std::size_t sent = 0; sent < bytes;) {
    const std::size_t size = std::min(block.size(), bytes - sent);
    for (std::size_t i = 0; i < size; ++i) block[i] = static_cast<char>((sent + i) % 257 % 256);
    if (std::fwrite(block.data(), 1, size, stdout) != size) std::exit(1);
    sent += size;
  }
}

// Grandchild and child wait for a signal, too.
[[noreturn]] void Tree() {
  const pid_t child = fork();
  if (child == 0) {
    const pid_t grandchild = fork();
    if (grandchild == 0) {
      std::cout << "grandchild " << getpid() << std::endl;
      Wait();
    }
    WaitSilently();
  }
  std::cout << "child " << child << std::endl;
  Wait();
}

// As daemons start: parent and child end, the grandchild is in a session of its own.
void Daemon() {
  const pid_t child = fork();
  if (child == 0) {
    setsid();
    const pid_t grandchild = fork();
    if (grandchild > 0) _exit(0);
    std::cout << "daemon " << getpid() << std::endl;
    Wait();
  }
  waitpid(child, nullptr, 0);
}

std::string OwnPath() {
  return std::filesystem::read_symlink("/proc/self/exe");
}

// Starts a child that waits, says its pid, and waits. The child is proof against being hung up,
// which the end of this process does, too.
[[noreturn]] void StartOnTerminal(int death_signal) {
  const auto child =
      clearway::host::StartOnTerminal({.program = OwnPath(),
                                       .arguments = {"child", "ignore", std::to_string(SIGHUP)},
                                       .environment = {},
                                       .working_folder = {},
                                       .parent_death_signal = death_signal});
  // Only when it runs: its signal at our death is set then.
  std::array<char, 64> text{};
  while (clearway::host::ReadOutput(child.output_fd, text).size == 0) {
  }
  std::cout << child.pid << std::endl;
  Wait();
}

[[noreturn]] void StartChildProcess(int death_signal) {
  std::signal(SIGHUP, SIG_IGN);  // Goes on to the child.
  const clearway::host::ChildProcess child(
      "child", {OwnPath(), "wait_silently"}, "/dev/null", death_signal);
  std::cout << child.pid() << std::endl;
  Wait();
}

void SetName(const char* name) {
  prctl(PR_SET_NAME, name);
}

int Run(const std::string& action, const std::string& value) {
  if (action == "terminal") SayTerminal();
  if (action == "descriptors") SayDescriptors();
  if (action == "signals") SaySignals();
  if (action == "environment") SayEnvironment();
  if (action == "folder") std::cout << std::filesystem::current_path().string() << '\n';
  if (action == "say") std::cout << value;
  if (action == "complain") std::cerr << value;
  if (action == "flood") Flood(std::stoul(value));
  if (action == "exit") return std::stoi(value);
  if (action == "name") SetName(value.c_str());
  if (action == "ignore") std::signal(std::stoi(value), SIG_IGN);
  if (action == "wait_silently") WaitSilently();
  if (action == "tree") Tree();
  if (action == "daemon") Daemon();
  if (action == "start_on_terminal") StartOnTerminal(std::stoi(value));
  if (action == "start_child_process") StartChildProcess(std::stoi(value));
  if (action == "name" || action == "ignore" || action == "wait") Wait();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  return Run(argc > 1 ? argv[1] : "", argc > 2 ? argv[2] : "");
}
