// Sends one goal as a ROS 2 client does (ros_client.h) and prints what became of it:  send_goal DOMAIN Q1 Q2
// "ID accepted" once it is taken, ID in hexadecimal, and "STATUS CODE" in the end.
#include <cstdio>
#include <cstdlib>

#include "tests/service/ros2/ros_client.h"

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  ros2_test::Client client(static_cast<dds_domainid_t>(std::atoi(argv[1])));
  for (int i = 0; !client.server_is_available(); ++i) {
    if (i == 300) return 1;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  ros2_test::Goal goal;
  goal.points.push_back({.positions = {std::atof(argv[2]), std::atof(argv[3])}});
  const ros2_test::Uuid id = ros2_test::random_uuid();
  if (client.send(id, goal) != true) return 1;
  for (const std::uint8_t byte : id) std::printf("%02x", byte);
  std::printf(" accepted\n");
  std::fflush(stdout);
  const auto result = client.result(id, 60);
  if (!result) return 1;
  std::printf("%d %d\n", result->status, result->code);
  return 0;
}
