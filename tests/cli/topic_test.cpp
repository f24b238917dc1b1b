// SPDX-License-Identifier: MIT
// --topic by the real binary, on a bag and on an MCAP file made byte by byte.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/message_bytes.hpp"
#include "formats/ros1_bag_bytes.hpp"
#include "support/program.hpp"
#include "support/temp_dir.hpp"

namespace kissmap {
namespace {

namespace fs = std::filesystem;
using test::little;
using test::ProtobufBytes;
using test::RosForm;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr std::uint32_t start_s = 1'700'000'000;

std::string cloud(RosForm form, float x) {
  test::CloudOfBytes cloud = test::plain_cloud({{x, 2, 3}});
  cloud.seconds = start_s;
  return point_cloud2(form, cloud);
}

/// Two topics with clouds, one with another thing, and one on which nothing was sent.
std::string bag() {
  return test::Ros1BagBytes({{0, "/imu", "sensor_msgs/Imu"},
                             {1, "/front", "sensor_msgs/PointCloud2"},
                             {2, "/rear", "sensor_msgs/PointCloud2"},
                             {3, "/silent", "sensor_msgs/PointCloud2"}},
                            {{{0, start_s, 0, "?"},
                              {1, start_s, 1, cloud(RosForm::ros1, 10)},
                              {2, start_s, 2, cloud(RosForm::ros1, 20)}},
                             {{1, start_s, 3, cloud(RosForm::ros1, 11)}}})
      .closed();
}

std::string text32(const std::string& text) {
  return little<std::uint32_t>(static_cast<std::uint32_t>(text.size())) + text;
}
std::string mcap_record(char op, const std::string& content) {
  return op + little<std::uint64_t>(content.size()) + content;
}
std::string mcap_channel(std::uint16_t id,
                         const std::string& topic,
                         const std::string& type,
                         const std::string& encoding) {
  const std::string number = little<std::uint16_t>(id);
  return mcap_record(3, number + text32(type) + text32("") + text32("")) +
         mcap_record(4, number + number + text32(topic) + text32(encoding) + text32(""));
}
std::string mcap_message(std::uint16_t channel, std::uint64_t ns, const std::string& data) {
  return mcap_record(5,
                     little<std::uint16_t>(channel) + little<std::uint32_t>(0) +
                         little<std::uint64_t>(ns) + little<std::uint64_t>(ns) + data);
}

std::string foxglove_cloud(float x) {
  ProtobufBytes message;
  message.block(1, ProtobufBytes().varint(1, start_s).bytes()).fixed32(4, 12);
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z"}) {
    message.block(5, ProtobufBytes().block(1, name).fixed32(2, offset).varint(3, 7).bytes());
    offset += 4;
  }
  return message.block(6, little<float>(x) + little<float>(2) + little<float>(3)).bytes();
}

/// The same topics, of ROS 2 and of protobuf, without chunks and without a summary.
std::string mcap() {
  const std::string magic = "\x89MCAP0\r\n";
  constexpr std::uint64_t start_ns = 1'700'000'000'000'000'000;
  return magic + mcap_record(1, text32("") + text32("")) +
         mcap_channel(1, "/imu", "sensor_msgs/msg/Imu", "cdr") +
         mcap_channel(2, "/front", "sensor_msgs/msg/PointCloud2", "cdr") +
         mcap_channel(3, "/rear", "foxglove.PointCloud", "protobuf") +
         mcap_channel(4, "/silent", "sensor_msgs/msg/PointCloud2", "cdr") +
         mcap_message(1, start_ns, "?") +
         mcap_message(2, start_ns + 1, cloud(RosForm::cdr_little, 10)) +
         mcap_message(3, start_ns + 2, foxglove_cloud(20)) +
         mcap_message(2, start_ns + 3, cloud(RosForm::cdr_big, 11)) +
         mcap_record(15, std::string(4, '\0')) + mcap_record(2, std::string(20, '\0')) + magic;
}

struct Container {
  const char* name;
  std::string (*bytes)();
  const char* rear_type;
};

class TopicOption : public testing::TestWithParam<Container> {
 protected:
  void SetUp() override {
    log_ = path(GetParam().name);
    std::ofstream(log_, std::ios::binary) << GetParam().bytes();
  }
  fs::path path(const std::string& name) const { return temp_.path() / name; }
  ProgramResult kissmap(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), KISSMAP_BINARY);
    return run_program(arguments);
  }
  ProgramResult convert(const std::string& topic, const std::string& out) const {
    return kissmap({"convert", log_, "-o", path(out), "--to", "kitti", "--topic", topic});
  }
  std::string scan(const std::string& out, const char* name) const {
    return file_text(path(out) / "sequences/00/velodyne" / name);
  }

  fs::path log_;

 private:
  TempDir temp_;
};

TEST_P(TopicOption, IsAskedForWhereSeveralTopicsHoldScans) {
  const std::vector<std::vector<std::string>> commands{
      {"info", log_},
      {"convert", log_, "-o", path("out"), "--to", "pcd"},
      {"run", log_, "-o", path("out")}};
  for (const auto& command : commands) {
    const ProgramResult result = kissmap(command);
    EXPECT_EQ(result.exit_code, 3) << command[0];
    EXPECT_THAT(result.err,
                AllOf(HasSubstr(log_.string()),
                      HasSubstr("--topic"),
                      HasSubstr("/front  (sensor_msgs/PointCloud2, 2 messages)"),
                      HasSubstr("/rear  (" + std::string(GetParam().rear_type) + ", 1 messages)"),
                      Not(HasSubstr("/imu")),
                      Not(HasSubstr("/silent"))));
  }
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_P(TopicOption, ChoosesWhatIsRead) {
  const std::string behind = little<float>(2) + little<float>(3) + little<float>(0);
  ASSERT_EQ(convert("/front", "front").exit_code, 0);
  EXPECT_EQ(scan("front", "000000.bin"), little<float>(10) + behind);
  EXPECT_EQ(scan("front", "000001.bin"), little<float>(11) + behind);
  EXPECT_EQ(scan("front", "000002.bin"), "");
  ASSERT_EQ(convert("/rear", "rear").exit_code, 0);
  EXPECT_EQ(scan("rear", "000000.bin"), little<float>(20) + behind);
  EXPECT_EQ(scan("rear", "000001.bin"), "");
  const ProgramResult info = kissmap({"info", log_, "--topic", "/rear"});
  EXPECT_EQ(info.exit_code, 0) << info.err;
  EXPECT_THAT(info.out,
              AllOf(HasSubstr("scans       1\n"),
                    HasSubstr("scans from topic /rear"),
                    HasSubstr("topic       /imu (sensor_msgs/Imu, 1 messages)"),
                    HasSubstr("topic       /front (sensor_msgs/PointCloud2, 2 messages)"),
                    HasSubstr("topic       /silent (sensor_msgs/PointCloud2, 0 messages)")));
}

TEST_P(TopicOption, ThatIsNotThereOrHoldsNoScansIsAnErrorWithTheList) {
  const auto all =
      AllOf(HasSubstr("/imu  (sensor_msgs/Imu"), HasSubstr("/front  ("), HasSubstr("/rear  ("));
  for (const char* command : {"info", "run"}) {
    std::vector<std::string> arguments{command, log_, "--topic", "/left"};
    if (command == std::string("run")) arguments.insert(arguments.end(), {"-o", path("out")});
    const ProgramResult result = kissmap(arguments);
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("/left"), HasSubstr(log_.string()), all));
  }
  const ProgramResult imu = convert("/imu", "out");
  EXPECT_EQ(imu.exit_code, 2);
  EXPECT_THAT(imu.err, AllOf(HasSubstr("/imu: kissmap reads no scans"), all));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_P(TopicOption, OfATopicWithoutMessagesIsAnError) {
  const ProgramResult result = convert("/silent", "out");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.err, AllOf(HasSubstr(log_.string()), HasSubstr("no scan")));
  EXPECT_FALSE(fs::exists(path("out")));
}

INSTANTIATE_TEST_SUITE_P(Containers,
                         TopicOption,
                         testing::Values(Container{"log.bag", bag, "sensor_msgs/PointCloud2"},
                                         Container{"log.mcap", mcap, "foxglove.PointCloud"}),
                         [](const auto& container) {
                           return std::string(container.param.name).substr(4);
                         });

}  // namespace
}  // namespace kissmap
