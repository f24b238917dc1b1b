// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>

#include <random>

#include "kissmap/formats/session.hpp"
#include "session/example_session.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

class DamagedSession : public testing::Test {
 protected:
  DamagedSession() { write_session(example_session(), example_surfels(), path_); }

  std::string error() const {
    return error_of([&] {
      const Session session = read_session(path_);
      for (const LocalMap& map : session.local_maps) read_local_map_surfels(path_, map.id);
    });
  }

  // Replaces the first `from` in a file and puts the file back after `check`.
  template <typename Check>
  void with_replaced(const std::string& name,
                     const std::string& from,
                     const std::string& to,
                     const Check& check) const {
    const std::string original = read_file(path_ / name);
    const std::size_t at = original.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    write_file(path_ / name, std::string(original).replace(at, from.size(), to));
    check();
    write_file(path_ / name, original);
  }

  void expect_every_cut_refused(const std::string& name, std::size_t harmless = 0) const {
    const std::string original = read_file(path_ / name);
    ASSERT_GT(original.size(), harmless);
    for (std::size_t size = 0; size + harmless < original.size(); ++size) {
      write_file(path_ / name, original.substr(0, size));
      ASSERT_THAT(error(), AllOf(StartsWith("input: "), HasSubstr(name))) << "cut to " << size;
    }
    write_file(path_ / name, original);
    ASSERT_EQ(error(), "no error");
  }

  TempDir folder_;
  std::filesystem::path path_ = folder_.path() / "session";
};

TEST_F(DamagedSession, EveryCutOfTheManifestIsRefused) {
  expect_every_cut_refused("session.json", 1);  // the last byte only ends the line
}

TEST_F(DamagedSession, EveryCutOfTheScansIsRefused) {
  expect_every_cut_refused("scans.csv");
}

TEST_F(DamagedSession, EveryCutOfTheLocalMapsIsRefused) {
  expect_every_cut_refused("local_maps.csv");
}

TEST_F(DamagedSession, EveryCutOfSurfelsIsRefused) {
  expect_every_cut_refused("local_maps/000001.ply");
}

TEST_F(DamagedSession, EveryCutOfTheConfigurationIsRefused) {
  expect_every_cut_refused("config.toml");
}

TEST_F(DamagedSession, SurfelsWithBytesLeftOverAreRefused) {
  const auto file = path_ / "local_maps" / "000001.ply";
  write_file(file, read_file(file) + '\0');
  EXPECT_THAT(error(), HasSubstr("000001.ply"));
}

TEST_F(DamagedSession, MissingFilesAreNamed) {
  for (const char* name :
       {"session.json", "config.toml", "scans.csv", "local_maps.csv", "local_maps/000002.ply"}) {
    std::filesystem::rename(path_ / name, folder_.path() / "away");
    EXPECT_THAT(error(), AllOf(StartsWith("input: "), HasSubstr(name)));
    std::filesystem::rename(folder_.path() / "away", path_ / name);
  }
}

TEST_F(DamagedSession, AnotherFormatVersionIsRefusedWithTheCure) {
  for (const char* version : {"3", "4294967297", "1", "0"}) {
    with_replaced("session.json",
                  "\"format_version\": 2",
                  std::string("\"format_version\": ") + version,
                  [&] {
                    EXPECT_THAT(
                        error(),
                        AllOf(HasSubstr("version " + std::string(version)), HasSubstr("newer")));
                  });
  }
}

TEST_F(DamagedSession, UnfinishedManifestIsRefusedWithTheCure) {
  with_replaced("session.json", "\"finished\": true", "\"finished\": false", [&] {
    EXPECT_THAT(error(), AllOf(HasSubstr("never finished"), HasSubstr("kissmap run")));
  });
}

TEST_F(DamagedSession, WrongKindsOfJsonValuesAreRefusedByName) {
  const std::vector<std::array<std::string, 3>> cases = {
      {"\"scans_read\": 17", "\"scans_read\": -17", "scans_read"},
      {"\"scans_read\": 17", "\"scans_read\": 17.5", "scans_read"},
      {"\"scans_read\": 17", "\"scans_red\": 17", "scans_read"},
      {"\"bin_columns\": 7", "\"bin_columns\": 7000000000", "bin_columns"},
      {"\"finished\": true", "\"finished\": 1", "finished"},
      {"\"program_version\": \"9.8.7\"", "\"program_version\": null", "program_version"},
      {"\"format\": \"kissmap session\"", "\"format\": \"recipe\"", "not the manifest"}};
  for (const auto& [from, to, name] : cases) {
    with_replaced("session.json", from, to, [&] {
      EXPECT_THAT(error(), AllOf(StartsWith("input: "), HasSubstr(name)));
    });
  }
}

TEST_F(DamagedSession, TableErrorsNameLineAndColumn) {
  const std::vector<std::array<std::string, 4>> cases = {
      {"scans.csv", "\n5,", "\nfive,", "line 3: column log_index 'five'"},
      {"scans.csv", "\n5,", "\n-5,", "line 3: column log_index '-5'"},
      {"scans.csv", "\n5,", "\n5.0,", "line 3: column log_index '5.0'"},
      {"scans.csv", "\n5,", "\n3,", "line 3: column converged"},
      {"scans.csv", "\n5,", "\n", "line 3: 22 columns instead of 23"},
      {"scans.csv", "log_index", "log_idx", "line 1: the header"},
      {"local_maps.csv", "\n1,", "\n2,", "line 3: column local_map_id"},
      {"local_maps.csv", "split", "splat", "line 2: column end 'splat'"},
      {"local_maps.csv", "\n0,0,0,0,", "\n0,nan,0,0,", "line 2: column map_from_local_map_x 'nan'"},
      {"local_maps.csv", "\n0,0,0,0,", "\n0,1e999,0,0,", "line 2: column map_from_local_map_x"},
      {"local_maps.csv", ",0,0,0,1,", ",0,0,1,1,", "line 2: column map_from_local_map_qw"}};
  for (const auto& [file, from, to, place] : cases) {
    with_replaced(file, from, to, [&] {
      EXPECT_THAT(error(), AllOf(StartsWith("input: "), HasSubstr(file), HasSubstr(place)));
    });
  }
}

TEST_F(DamagedSession, RandomBytesNeverCrash) {
  std::mt19937 random(9);
  for (const char* name :
       {"session.json", "scans.csv", "local_maps.csv", "local_maps/000001.ply"}) {
    const std::string original = read_file(path_ / name);
    std::uniform_int_distribution<std::size_t> places(0, original.size() - 1);
    for (int i = 0; i < 300; ++i) {
      std::string bytes = original;
      bytes[places(random)] = static_cast<char>(random());
      write_file(path_ / name, bytes);
      EXPECT_THAT(error(), testing::AnyOf(StartsWith("input: "), "no error"));
    }
    write_file(path_ / name, original);
  }
}

TEST_F(DamagedSession, WhatIsNoSessionIsNotTakenForOne) {
  EXPECT_FALSE(is_session(folder_.path()));
  EXPECT_FALSE(is_session(folder_.path() / "missing"));
  EXPECT_FALSE(is_session(path_ / "session.json"));
  EXPECT_THAT(error_of([&] { read_session(folder_.path() / "missing"); }),
              AllOf(StartsWith("input: "), HasSubstr("kissmap run")));
  EXPECT_THAT(error_of([&] { read_session(folder_.path()); }), StartsWith("input: "));
}

}  // namespace
}  // namespace kissmap
