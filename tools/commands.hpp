// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "configuration.hpp"
#include "kissmap/formats/scan_log.hpp"
#include "kissmap/graph/pose_graph.hpp"
#include "kissmap/grid/grid_map.hpp"

namespace kissmap {

struct RunCommand {
  std::filesystem::path log;
  std::filesystem::path session;
  std::string format;
  ConfigurationFlags configuration;
  ScanSelection selection;
  int threads = 0;
  bool pack = false;
  bool no_loop_closing = false;
  bool no_products = false;
  bool overwrite = false;
  bool quiet = false;
};
void run(const RunCommand& command);

struct InfoCommand {
  std::filesystem::path path;
  std::string format;
  ReadOptions options;
  bool all = false;
};
void info(const InfoCommand& command);

struct ConvertCommand {
  std::filesystem::path log;
  std::filesystem::path output;
  std::string to;
  std::string format;
  ReadOptions options;
  ScanSelection selection;
  bool quiet = false;
};
void convert(const ConvertCommand& command);

struct PackCommand {
  std::filesystem::path session;
  std::filesystem::path log;
};
void pack(const PackCommand& command);

struct OptimizeCommand {
  std::filesystem::path input;   ///< graph or session
  std::filesystem::path output;  ///< empty: a session is changed in place
  std::filesystem::path edits;   ///< empty: none, or those that a session keeps
  std::string start;             ///< "file", "tree", "chordal"; empty: what the input allows
  PoseGraphOptions options;
  bool drop_coupling = false;  ///< of edges with negative information
  bool overwrite = false;
  bool quiet = false;
  std::string graph_option;  ///< given, though it has a meaning for graphs only; empty: none
};
void optimize(const OptimizeCommand& command);
void optimize_session(const OptimizeCommand& command);

struct EvalCommand {
  std::vector<std::filesystem::path> estimates;
  std::filesystem::path reference;
  std::filesystem::path times;        ///< stamps for trajectories that have none
  std::string topic;                  ///< scene of a nuScenes reference
  std::filesystem::path calibration;  ///< calib.txt of KITTI: estimates of the LiDAR
  std::string mount;                  ///< of the LiDAR in the reference's frame
  double tolerance = 0.01;            ///< s
  double offset = 0.0;                ///< s
  bool interpolate = false;
  double max_gap = 0.25;  ///< s, of what is interpolated
  std::string align = "se3";
  std::vector<std::string> deltas;  ///< "1f", "10m", "0.5s"; empty: the default
  bool all_pairs = false;
  std::vector<double> segments;  ///< m; empty: chosen by the length of the way
  std::filesystem::path json;
  std::filesystem::path csv;
  std::filesystem::path plot;
};
void eval(const EvalCommand& command);

struct ExportGridCommand {
  std::filesystem::path session;
  std::filesystem::path output;
  std::filesystem::path log;
  std::string purpose = "navigation";
  std::optional<double> z_min;  ///< m
  std::optional<double> z_max;  ///< m
  double resolution = 0.0;      ///< m; 0: by how near things are
  bool floor_reference = true;
  std::string mode = "trinary";
  ColumnRule rule;
  std::optional<double> threshold;   ///< none: by purpose
  double no_return_range = 0.0;      ///< m; 0: off
  std::optional<int> min_group;      ///< cells; none: by purpose
  std::optional<double> half_width;  ///< m; none: by speed
  std::vector<double> crop;          ///< x_min, y_min, x_max, y_max [m]; or empty
  bool connected = false;
  bool align_axes = false;
  double max_memory = 4.0;  ///< GB
  int threads = 0;
  bool overwrite = false;
  bool quiet = false;
};
void export_grid(const ExportGridCommand& command);

struct ExportVoxelsCommand {
  std::filesystem::path session;
  std::filesystem::path output;
  std::filesystem::path log;
  double resolution = 0.0;  ///< m; 0: by how near things are
  double threshold = 0.5;
  double no_return_range = 0.0;  ///< m; 0: off
  std::string frame = "level";
  double max_memory = 4.0;  ///< GB
  int threads = 0;
  bool overwrite = false;
  bool quiet = false;
};
void export_voxels(const ExportVoxelsCommand& command);

struct ExportCloudCommand {
  std::filesystem::path session;
  std::filesystem::path output;
  std::filesystem::path log;
  std::optional<double> voxel_size;  ///< m; none: from the session's configuration
  std::string fields;                ///< empty: intensity where the log has it
  std::string colour;                ///< "height", or empty
  std::string crop;                  ///< xmin,ymin,xmax,ymax [m]; empty: all
  std::filesystem::path crop_polygon;
  std::optional<double> z_min;  ///< m
  std::optional<double> z_max;
  std::string frame = "level";
  int tile_size = 0;  ///< m; 0: no tiles
  int threads = 0;
  bool remove_outliers = false;
  bool remove_dynamic = false;
  bool compress = false;
  bool overwrite = false;
  bool quiet = false;
};
void export_cloud(const ExportCloudCommand& command);

/// The default products of a session: what `kissmap run` writes into SESSION/products.
struct ProductsCommand {
  std::filesystem::path session;
  std::filesystem::path log;
  int threads = 0;
  bool quiet = false;
};
void write_products(const ProductsCommand& command);

void list_formats();
void print_default_configuration();

}  // namespace kissmap
