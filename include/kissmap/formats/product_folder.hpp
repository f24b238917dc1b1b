// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>

namespace kissmap {

/// Names of the default products inside SESSION/products.
inline constexpr const char* cloud_product_name = "cloud.pcd";
inline constexpr const char* voxels_product_name = "voxels.bt";
inline constexpr const char* grid_product_stem = "grid";

/// A session's default products while they are being written: in SESSION/products.partial, which
/// becomes SESSION/products in publish() and is removed without. Not thread safe.
class ProductFolder {
 public:
  /// Throws Error(output) where the folders cannot be written, are being written by another run,
  /// or hold files that are no products.
  explicit ProductFolder(const std::filesystem::path& session);
  ~ProductFolder();

  const std::filesystem::path& path() const;  ///< where to write

  /// Replaces the products that are there. Returns the folder's final path. Throws Error(output).
  std::filesystem::path publish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Removes the default products of a session. Returns whether there were any. Throws Error(output).
bool remove_products(const std::filesystem::path& session);

}  // namespace kissmap
