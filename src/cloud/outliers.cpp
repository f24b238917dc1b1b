// SPDX-License-Identifier: MIT
#include "kissmap/cloud/outliers.hpp"

// PCL's templates are compiled here: its libraries of all of them for all points take 20 ms to
// load, which every command would pay.
#define PCL_NO_PRECOMPILE
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <numeric>

namespace kissmap {

std::vector<std::uint32_t> find_inliers(std::span<const Eigen::Vector3f> points,
                                        const OutlierOptions& options) {
  std::vector<std::uint32_t> kept(points.size());
  std::iota(kept.begin(), kept.end(), 0U);
  if (points.size() <= static_cast<std::size_t>(options.neighbors)) return kept;
  const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
  filter.setInputCloud(cloud);
  filter.setMeanK(options.neighbors);
  filter.setStddevMulThresh(options.max_deviations);
  pcl::Indices inliers;
  filter.filter(inliers);
  kept.assign(inliers.begin(), inliers.end());
  return kept;
}

}  // namespace kissmap
