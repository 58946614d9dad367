// Certifies a trajectory file: check TRAJECTORY.csv
#include <iostream>

#include "common/input_error.h"
#include "planner/certificate/certificate.h"

int main(int count, char** arguments) {
  try {
    if (count != 2) throw fjr::InputError("check", "", "needs one trajectory.csv");
    const fjr::Parameters robot = fjr::load_parameters(fjr::default_robot_file());
    const fjr::Certificate certificate = fjr::certify(robot, fjr::Limits::of(robot), fjr::read_csv(arguments[1]));
    for (const std::string& failure : certificate.failures) std::cout << failure << '\n';
    std::cout << (certificate.certified ? "certified\n" : "not certified\n");
    return certificate.certified ? 0 : 4;
  } catch (const fjr::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
