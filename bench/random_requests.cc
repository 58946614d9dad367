// Writes random requests that can be had for certain (tests/support/random_requests.h), for `fjr batch`: what share of
// them is certified says how robust the planner is.
#include "support/random_requests.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>

int main(int argc, char** argv) {
  CLI::App app{"Writes random feasible requests: DIR/random_<seed>.yaml"};
  std::filesystem::path out;
  std::uint64_t first = 1, count = 100;
  app.add_option("--out", out, "Folder of the requests")->required();
  app.add_option("--first", first, "Seed of the first");
  app.add_option("--count", count, "How many");
  CLI11_PARSE(app, argc, argv);
  const fjr::Parameters robot = fjr::load_parameters(FJR_SOURCE_DIR "/config/robot.yaml");
  std::filesystem::create_directories(out);
  for (std::uint64_t seed = first; seed < first + count; ++seed) {
    const fjr::RandomRequest request = fjr::random_request(robot, seed);
    std::ofstream file(out / fmt::format("random_{}.yaml", seed));
    file << "# " << request.kind << fmt::format("; from a motion of {:.4f} s\n", request.duration) << request.yaml;
    if (!file.flush()) throw std::runtime_error("cannot write " + out.string());
  }
}
