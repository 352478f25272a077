// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "processes/procman_sheriff/screen_text.hpp"

/// The parts that Compose() puts together. Widths are of the whole line.
namespace clearway::screen {

using Lines = std::vector<Line>;

// screen_frame.cpp
[[nodiscard]] Line TitleLine(const ScreenModel& model, int width, const std::string& clock);
[[nodiscard]] Lines BannerLines(const ScreenModel& model, int width);
/// Keys, or what is asked, searched or noted.
[[nodiscard]] Line KeysLine(const ScreenModel& model, int width);
/// A line that begins a part.
[[nodiscard]] Line HeaderLine(const std::string& text, int width, const std::string& right = "");

// screen_hosts.cpp
[[nodiscard]] Lines HostLines(const ScreenModel& model, int width, const ScreenAreas& areas);

// screen_table.cpp
[[nodiscard]] Lines TableLines(const ScreenModel& model, int width, const ScreenAreas& areas);

// screen_pages.cpp
[[nodiscard]] Lines PaneLines(const ScreenModel& model, int width, int rows);
[[nodiscard]] Lines OutputPage(const ScreenModel& model, int width, int rows);
[[nodiscard]] Lines ScriptsPage(const ScreenModel& model, int width, int rows);
[[nodiscard]] int HelpLines();
[[nodiscard]] Lines HelpPage(const ScreenModel& model, int width, int rows);

/// The word of a status with its style, and the mark before a name: '!' trouble, '~' on its way,
/// '?' not known.
[[nodiscard]] Style StyleOf(core::procman::Status status);
[[nodiscard]] char MarkOf(core::procman::Status status);
/// Why a command is as it is, and what differs from the file.
[[nodiscard]] std::string ReasonOf(const core::procman::CommandView& command);

}  // namespace clearway::screen
