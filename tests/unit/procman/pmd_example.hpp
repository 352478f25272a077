// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "common/io/procman/pmd_reader.hpp"
#include "tests/unit/io/map/refusal.hpp"

namespace clearway::test {

/// A deployment with every part of the grammar.
inline const std::string kPmdExample = R"(# A rig and what stops it.
group "sense" {
    cmd "lidar-driver"  { exec = "LCM_DEFAULT_URL=udpm://239.255.76.67:7667?ttl=0 lidar_driver --config ${RIG_CFG}"; deputy = "rig";
                          auto_respawn = "true"; stop_signal = 2; stop_time_allowed = 3; }
    group "perceive" {
        cmd "preprocessor" { exec = "preprocessor"; deputy = "rig"; auto_respawn = "true"; }
        cmd "clusterer"    { exec = "clusterer --min-points 10"; deputy = "rig"; auto_respawn = "true"; }
    }
}
cmd "stop-guard" { exec = "stop_guard"; deputy = "rig"; auto_respawn = "true"; stop_signal = 15; stop_time_allowed = 2; }
script "bring-up" { start cmd "stop-guard" wait "running"; start cmd "lidar-driver" wait "running"; wait ms 500; start group "sense/perceive" wait "running"; }
script "down"     { stop everything wait "stopped"; }
script "again"    { run_script "down"; restart cmd "stop-guard"; wait group "sense" status "stopped"; run_script "bring-up"; }
)";

/// The message with which a deployment d.pmd of this text is refused; empty when it is not.
inline std::string PmdRefusal(const std::string& text) {
  return RefusalOf([&] { return io::ParsePmd(text, "d.pmd"); });
}

}  // namespace clearway::test
