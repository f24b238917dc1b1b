// SPDX-License-Identifier: MIT
// kissmap export-cloud, as a user calls it, on a simulated session whose trajectory is the truth.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "products/cloud_table.hpp"
#include "products/true_session.hpp"
#include "simulator/log_folder.hpp"
#include "simulator/scenario.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {

namespace fs = std::filesystem;

inline ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

inline simulator::Scenario short_tour() {
  simulator::Scenario scenario{"office", "spinning16", "robot", 1, 20};
  scenario.columns = 150;
  return scenario;
}

class ExportCloud : public testing::Test {
 protected:
  fs::path path(const std::string& name) const { return folder_.path() / name; }

  void make_session(const std::string& name = "session",
                    const Eigen::Vector3d& shift = Eigen::Vector3d::Zero()) const {
    if (!fs::exists(path("log"))) {
      simulator::write_log_folder(simulator_, path("log"), 1, [](std::size_t) {});
    }
    Rigid3 map_from_world;
    map_from_world.translation = shift;
    write_true_session(path("log"), path(name), [&](const Scan& scan) {
      return true_place(simulator_, scan, map_from_world);
    });
  }

  ProgramResult run(const std::string& output,
                    std::vector<std::string> more = {},
                    const std::string& session = "session") const {
    more.insert(more.begin(), {"export-cloud", path(session), "-o", path(output)});
    return kissmap(more);
  }
  CloudTable cloud(const std::string& output,
                   const std::vector<std::string>& more = {},
                   const std::string& session = "session") const {
    const ProgramResult result = run(output, more, session);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return read_cloud(path(output));
  }

  simulator::Simulator simulator_ = simulator::make_simulator(short_tour());

 private:
  TempDir folder_;
};

}  // namespace kissmap
