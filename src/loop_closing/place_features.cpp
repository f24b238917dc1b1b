// SPDX-License-Identifier: MIT
#include "kissmap/loop_closing/place_features.hpp"

#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

namespace kissmap {
namespace {

constexpr int max_features = 500;
constexpr int patch = 31;  // pixels
constexpr int fast_threshold = 35;
constexpr int self_similar = 35;  // bits

// ORB leaves out what is nearer than a patch to the border; an empty frame brings it in.
cv::Mat framed(const DensityImage& image) {
  cv::Mat frame(image.height + 2 * patch, image.width + 2 * patch, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < image.height; ++row) {
    std::memcpy(frame.ptr(row + patch) + patch,
                image.pixels.data() + static_cast<std::ptrdiff_t>(row) * image.width,
                static_cast<std::size_t>(image.width));
  }
  return frame;
}

std::vector<Descriptor> descriptors_of(const cv::Mat& rows) {
  std::vector<Descriptor> descriptors(static_cast<std::size_t>(rows.rows));
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    std::memcpy(descriptors[i].data(), rows.ptr(static_cast<int>(i)), sizeof(Descriptor));
  }
  return descriptors;
}

bool is_self_similar(const std::vector<Descriptor>& all, std::size_t i) {
  for (std::size_t j = 0; j < all.size(); ++j) {
    if (j != i && hamming_distance(all[i], all[j]) < self_similar) return true;
  }
  return false;
}

}  // namespace

PlaceFeatures place_features(const DensityImage& image) {
  PlaceFeatures features;
  if (image.empty()) return features;
  const auto orb = cv::ORB::create(
      max_features, 1.0F, 1, patch, 0, 2, cv::ORB::HARRIS_SCORE, patch, fast_threshold);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat rows;
  orb->detectAndCompute(framed(image), cv::noArray(), keypoints, rows);
  const std::vector<Descriptor> all = descriptors_of(rows);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (is_self_similar(all, i)) continue;
    // OpenCV counts from the centre of the first pixel.
    const Eigen::Vector2d pixel(keypoints[i].pt.x - patch + 0.5, keypoints[i].pt.y - patch + 0.5);
    features.positions.emplace_back((image.corner + image.pixel_size * pixel).cast<float>());
    features.descriptors.push_back(all[i]);
  }
  return features;
}

}  // namespace kissmap
