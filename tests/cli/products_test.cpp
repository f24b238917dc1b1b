// SPDX-License-Identifier: MIT
// The default products of `kissmap run`, by the real binary.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "support/folder_content.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"
#include "support/yard_log.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

ProgramResult kissmap(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), KISSMAP_BINARY);
  return run_program(arguments);
}

class Products : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_ = new TempDir;
    write_yard_log(shared_->path() / "log", 40);
    const ProgramResult result =
        kissmap({"run", shared_->path() / "log", "-o", shared_->path() / "session"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    output_ = result.out;
  }
  static void TearDownTestSuite() {
    delete shared_;
    shared_ = nullptr;
  }

  static fs::path log() { return shared_->path() / "log"; }
  static fs::path session() { return shared_->path() / "session"; }
  fs::path path(const std::string& name) const { return folder_.path() / name; }
  fs::path copied_session() const {
    fs::copy(session(), path("copy"), fs::copy_options::recursive);
    return path("copy");
  }

  TempDir folder_;
  inline static TempDir* shared_ = nullptr;
  inline static std::string output_;
};

TEST_F(Products, ARunWritesThemAndSaysSo) {
  for (const char* name : {"cloud.pcd", "voxels.bt", "grid.pgm", "grid.yaml", "grid_look.png"}) {
    EXPECT_GT(fs::file_size(session() / "products" / name), 100U) << name;
  }
  for (const char* name : {"cloud.pcd", "voxels.bt", "grid.yaml"})
    EXPECT_THAT(output_, HasSubstr(name));
  EXPECT_FALSE(fs::exists(session() / "products.partial"));
}

TEST_F(Products, ExportsOfTheSessionAreTheSame) {
  ASSERT_EQ(kissmap({"export-cloud", session(), "-o", path("cloud.pcd")}).exit_code, 0);
  ASSERT_EQ(kissmap({"export-voxels", session(), "-o", path("voxels.bt")}).exit_code, 0);
  ASSERT_EQ(kissmap({"export-grid", session(), "-o", path("grid")}).exit_code, 0);
  EXPECT_EQ(content_of(folder_.path()), content_of(session() / "products"));
}

TEST_F(Products, AreTheSameForAnyNumberOfThreads) {
  const fs::path copy = copied_session();
  const auto made = content_of(copy / "products");
  for (const char* threads : {"1", "3"}) {
    fs::remove_all(copy / "products");
    ASSERT_EQ(kissmap({"products", copy, "--threads", threads, "--quiet"}).exit_code, 0);
    EXPECT_EQ(content_of(copy / "products"), made) << threads;
  }
}

TEST_F(Products, CanBeLeftOut) {
  const ProgramResult result = kissmap({"run", log(), "-o", path("without"), "--no-products"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(fs::exists(path("without") / "products"));
  EXPECT_THAT(result.out, Not(HasSubstr("products")));
}

TEST_F(Products, AreReplacedWithTheirSession) {
  const fs::path copy = copied_session();
  ASSERT_EQ(kissmap({"run", log(), "-o", copy, "--overwrite", "--quiet"}).exit_code, 0);
  EXPECT_EQ(content_of(copy / "products"), content_of(session() / "products"));
}

TEST_F(Products, WhatAUserKeepsBesideThemIsNotLost) {
  const fs::path copy = copied_session();
  std::ofstream(copy / "products" / "notes.txt") << "mine";
  const auto before = content_of(copy);
  for (const ProgramResult& result :
       {kissmap({"products", copy}), kissmap({"run", log(), "-o", copy, "--overwrite"})}) {
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_THAT(result.err, HasSubstr("notes.txt"));
    EXPECT_EQ(content_of(copy), before);
  }
}

TEST_F(Products, WithoutTheLogThoseThatAreThereStay) {
  const fs::path copy = copied_session();
  const auto before = content_of(copy);
  const ProgramResult result = kissmap({"products", copy, "--log", path("nowhere")});
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, HasSubstr("nowhere"));
  EXPECT_EQ(content_of(copy), before);
}

TEST_F(Products, ASessionIsFinishedBeforeItsProducts) {
  // A log that changes while products are made cannot be had here; a folder in the way can.
  const fs::path copy = copied_session();
  std::ofstream(copy / "products.partial") << "in the way";
  const ProgramResult result = kissmap({"products", copy});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("products.partial"));
  EXPECT_EQ(kissmap({"info", copy}).exit_code, 0);
}

}  // namespace
}  // namespace kissmap
