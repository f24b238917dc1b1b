// SPDX-License-Identifier: MIT
#include <cstdlib>

#include "fuzz/input_file.hpp"
#include "fuzz/target.hpp"
#include "kissmap/error.hpp"
#include "kissmap/formats/trajectory_file.hpp"

KISSMAP_FUZZ_TARGET(trajectory) {
  const FuzzInputFile file(input);
  try {
    const TrajectoryFile read = read_trajectory(file.path());
    for (const Rigid3& pose : read.trajectory.poses) {
      if (!pose.matrix().allFinite()) std::abort();
    }
  } catch (const Error&) {
    // Refusing is an answer; crashing, hanging or poses that are none are not.
  }
}
