// service.yaml: whatever bytes it holds, a configuration or an InputError.
#include "planner/service/service_config.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "common/input_error.h"
#include "tests/support/process.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

TEST(ServiceConfig, MutatedFilesAreReadOrRefused) {
  const std::string shipped = contents(FJR_SOURCE_DIR "/config/service.yaml") + "security: keys\ninstance: cell-1\n";
  const fs::path file = fs::temp_directory_path() / ("fjr_service_config_test_" + std::to_string(::getpid()) + ".yaml");
  const std::string bytes = "{}[],:-#&*!|>'\"%@`?0123456789e.~<=\n\t truefals";
  std::mt19937 random(3);
  int read = 0, refused = 0;
  for (int i = 0; i < 1000; ++i) {
    std::string text = shipped;
    for (int edits = 1 + static_cast<int>(random() % 4); edits > 0; --edits) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text.erase(at, 1 + random() % 8);
          break;
        case 1:
          text.insert(at, 1, bytes[random() % bytes.size()]);
          break;
        default:
          text[at] = static_cast<char>(random());
      }
    }
    std::ofstream(file, std::ios::binary) << text;
    try {
      const ServiceConfig config = load_service_config(file);
      EXPECT_LE(config.network.domain, 230u);
      EXPECT_LE(config.workers, 64u);
      EXPECT_GE(config.queue, 1u);
      EXPECT_GT(config.budget, 0);
      EXPECT_GT(config.longest_budget, 0);
      ++read;
    } catch (const InputError& error) {
      EXPECT_FALSE(error.problem().empty());
      ++refused;
    } catch (const std::exception& error) {
      FAIL() << "round " << i << ": " << error.what() << "\n" << text;
    }
    ASSERT_FALSE(HasFailure()) << text;
  }
  fs::remove(file);
  EXPECT_GT(read, 50);
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace fjr
