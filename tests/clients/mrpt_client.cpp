// SPDX-License-Identifier: MIT
#include "clients/mrpt_client.hpp"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>

#include "kissmap/error.hpp"
#include "support/program.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
constexpr double pi = std::numbers::pi;

// Steps are stamped a tenth of a second apart, whatever they took: pf-localization compares with
// truth that is 0.2 s away at most, and takes round stamps for numbers of steps.
double stamp(std::size_t step) {
  return 1'700'000'000.05 + 0.1 * static_cast<double>(step);
}

mrpt::obs::CObservation2DRangeScan::Ptr observation(const LaserStep& step,
                                                    double stamp,
                                                    const LaserRobotOptions& robot) {
  auto scan = mrpt::obs::CObservation2DRangeScan::Create();
  const std::size_t n = step.ranges.size();
  scan->timestamp = mrpt::Clock::fromDouble(stamp);
  scan->sensorLabel = "LASER";
  scan->maxRange = static_cast<float>(robot.max_range);
  scan->stdError = static_cast<float>(robot.range_noise);
  scan->rightToLeft = true;
  // MRPT spreads its beams from end to end of the aperture, middle straight ahead.
  const double gap = 2.0 * pi / static_cast<double>(n);
  scan->aperture = static_cast<float>(2.0 * pi - gap);
  scan->sensorPose = mrpt::poses::CPose3D(0, 0, robot.height, -0.5 * gap, 0, 0);
  scan->resizeScan(n);
  for (std::size_t k = 0; k < n; ++k) {
    scan->setScanRange(k, step.ranges[k] > 0.0F ? step.ranges[k] : scan->maxRange);
    scan->setScanRangeValidity(k, step.ranges[k] > 0.0F);
  }
  return scan;
}

mrpt::obs::CActionCollection action(const Pose2& increment, double stamp) {
  mrpt::obs::CActionRobotMovement2D movement;
  mrpt::obs::CActionRobotMovement2D::TMotionModelOptions options;
  options.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
  options.gaussianModel.minStdXY = 0.01F;
  options.gaussianModel.minStdPHI = static_cast<float>(0.5 * pi / 180.0);
  movement.timestamp = mrpt::Clock::fromDouble(stamp);
  movement.computeFromOdometry(
      mrpt::poses::CPose2D(increment.x, increment.y, std::remainder(increment.yaw, 2.0 * pi)),
      options);
  mrpt::obs::CActionCollection actions;
  actions.insert(movement);
  return actions;
}

void write_truth(const std::vector<LaserStep>& steps, const fs::path& path) {
  std::ofstream file(path);
  file.precision(17);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const Pose2& pose = steps[i].world_from_robot;
    file << stamp(i) << ' ' << pose.x << ' ' << pose.y << ' ' << pose.yaw << '\n';
  }
}

void write_configuration(const Eigen::AlignedBox2d& start, const fs::path& path) {
  std::ofstream(path) << "[KLD_options]\nKLD_binSize_PHI_deg=10\nKLD_binSize_XY=0.1\n"
                         "KLD_delta=0.01\nKLD_epsilon=0.01\nKLD_maxSampleSize=5000\n"
                         "KLD_minSampleSize=150\nKLD_minSamplesPerBin=0\n"
                         "[PF_options]\nPF_algorithm=0\nresamplingMethod=3\nadaptiveSampleSize=0\n"
                         "BETA=0.5\nsampleSize=1\n"
                         "[DummyOdometryParams]\nminStdXY=0.1\nminStdPHI=2.0\n"
                         "[LocalizationExperiment]\nuse_3D_poses=false\nmap_file=map.gridmap.gz\n"
                         "rawlog_file=drive.rawlog\nlogOutput_dir=log\n"
                         "ground_truth_path_file=truth.txt\n3DSceneFrequency=1000000\n"
                         "experimentRepetitions=1\nparticles_count=2000\n"
                         "SHOW_PROGRESS_3D_REAL_TIME=false\ninit_PDF_mode=0\n"
                      << "init_PDF_min_x=" << start.min().x()
                      << "\ninit_PDF_max_x=" << start.max().x()
                      << "\ninit_PDF_min_y=" << start.min().y()
                      << "\ninit_PDF_max_y=" << start.max().y()
                      << "\n[MetricMap]\noccupancyGrid_count=1\npointsMap_count=0\n"
                         "likelihoodMapSelection=0\n"
                         "[MetricMap_occupancyGrid_00_creationOpts]\nresolution=0.05\n"
                         "[MetricMap_occupancyGrid_00_likelihoodOpts]\nlikelihoodMethod=4\n"
                         "LF_decimation=6\nLF_stdHit=0.2\nLF_maxCorrsDistance=0.5\nLF_zHit=0.95\n"
                         "LF_zRandom=0.05\nLF_maxRange=80\nLF_alternateAverageMethod=1\n";
}

// Its programs wait for a key when they fail, and have been seen to take all memory.
void run_in(const fs::path& folder, const std::string& command) {
  const ProgramResult result =
      run_program({"bash",
                   "-c",
                   "ulimit -v 4000000; cd '" + folder.string() + "' && exec timeout 300 " +
                       command + " < /dev/null"});
  if (result.exit_code != 0) {
    throw input_error(folder, command + " failed: " + result.out + result.err);
  }
}

}  // namespace

void write_rawlog(const std::vector<LaserStep>& steps,
                  const LaserRobotOptions& robot,
                  const fs::path& path) {
  mrpt::obs::CRawlog log;
  Pose2 before;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    mrpt::obs::CActionCollection actions =
        action(before.inverse() * steps[i].odometry_from_robot, stamp(i));
    log.insert(actions);
    before = steps[i].odometry_from_robot;
    mrpt::obs::CSensoryFrame frame;
    frame.insert(observation(steps[i], stamp(i), robot));
    log.insert(frame);
  }
  if (!log.saveToRawLogFile(path.string())) throw output_error(path, "cannot be written");
}

std::vector<double> localise_with_mrpt(const fs::path& map_yaml,
                                       const std::vector<LaserStep>& steps,
                                       const LaserRobotOptions& robot,
                                       const Eigen::AlignedBox2d& start,
                                       const fs::path& folder) {
  fs::create_directories(folder);
  write_rawlog(steps, robot, folder / "drive.rawlog");
  write_truth(steps, folder / "truth.txt");
  write_configuration(start, folder / "pf.ini");
  run_in(folder, std::string(MRPT_YAML_TO_GRID) + " -q -w -d . -i '" + map_yaml.string() + "'");
  fs::path converted = folder / map_yaml.stem();
  converted += ".gridmap.gz";
  if (converted.filename() != "map.gridmap.gz") fs::rename(converted, folder / "map.gridmap.gz");
  run_in(folder, std::string(MRPT_LOCALISATION) + " pf.ini");
  std::vector<double> errors;
  std::ifstream file(folder / "log_000_0002000" / "GT_error.txt");
  for (double error = 0.0; file >> error;) errors.push_back(error);
  if (errors.size() + 1 < steps.size()) {
    throw input_error(folder,
                      "pf-localization told " + std::to_string(errors.size()) + " errors for " +
                          std::to_string(steps.size()) + " steps");
  }
  return errors;
}

double median_error_with_mrpt(const std::filesystem::path& map_yaml,
                              const std::vector<LaserStep>& steps,
                              const LaserRobotOptions& robot,
                              const Eigen::AlignedBox2d& start,
                              const std::filesystem::path& folder,
                              const ErrorBounds& bounds) {
  double median = 0.0;
  for (int attempt = 0; attempt < 3; ++attempt) {
    std::vector<double> errors = localise_with_mrpt(
        map_yaml, steps, robot, start, folder / ("mrpt" + std::to_string(attempt)));
    errors.erase(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2));
    std::ranges::sort(errors);
    median = errors.at(errors.size() / 2);
    if (median >= bounds.least && median <= bounds.most) break;
  }
  return median;
}

}  // namespace kissmap
