// fjr: the command line.
#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/input_error.h"
#include "planner/batch/statuses.h"
#include "planner/program/commands.h"
#include "planner/program/misspelt.h"
#include "planner/results/plan_json.h"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 certified, 2 bad input, 3 infeasible or not converged, 4 certificate failed,\n"
    "            5 deadline or cancelled, 1 anything else; of several plans the largest.";

// A function of a library that may be there; what it returns is of no interest.
template <class Function, class... Arguments>
void call_if_loaded(const char* name, Arguments... arguments) {
  void* const function = dlsym(RTLD_DEFAULT, name);
  if (function != nullptr) (void)reinterpret_cast<Function*>(function)(arguments...);
}

// Plans are reproducible to the last bit, and not slowed down by idle BLAS threads, only with one thread. The BLAS is
// whatever the system has linked Ipopt to; a threaded OpenBLAS has read its environment before main() starts, so it is
// asked through its own functions, which other libraries do not have. It has also started a thread for every core by
// then, each of which keeps its core busy for a tenth of a second before it sleeps: they are ended, as OpenBLAS itself
// does before each fork().
void hold_blas_to_one_thread() {
  call_if_loaded<void(int)>("openblas_set_num_threads", 1);
  call_if_loaded<int()>("blas_thread_shutdown_");
}

// The subcommands that are not for planning, and --help, are the complete executable's: it takes this one's place.
void hand_over(const CLI::App& app, const std::vector<std::string>& words, char** argv) {
  const std::string first = words.empty() ? "" : words.front();
  const auto has_name = [&first](const CLI::App* command) { return command->check_name(first); };
  const std::filesystem::path complete = fjr::complete_program();
  if (complete.empty() || first == "--version" || !app.get_subcommands(has_name).empty()) return;
  ::execv(complete.c_str(), argv);
  throw std::runtime_error(fmt::format("the other commands are in {}, which cannot be started ({}); is it built?",
                                       complete.string(), std::strerror(errno)));
}

int run(const std::vector<std::string>& words, char** argv) {
  CLI::App app("fjr: certified trajectories for flexible-joint robots", "fjr");
  app.set_version_flag("--version", FJR_VERSION);
  app.require_subcommand(1);
  app.footer(kFooter);
  int exit_code = 0;
  for (const fjr::AddCommand add : fjr::commands()) add(app, exit_code);
  hand_over(app, words, argv);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // backwards, as CLI11 takes them
  } catch (const CLI::ParseError& error) {  // --help and --version arrive here too, with code 0
    if (error.get_exit_code() == 0) return app.exit(error);
    throw fjr::InputError("command line", "", fjr::refusal(app, words, error.what()) + " (see --help)");
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw std::runtime_error("cannot write to stdout");
  return exit_code;
}

// Where the command line asks for JSON, what is wrong is told so as well: commands print theirs when all is done.
int complain(const std::vector<std::string>& words, const std::string& problem, const std::string& field,
             int exit_code) {
  fmt::print(stderr, "fjr: {}\n", problem);
  if (std::find(words.begin(), words.end(), "--json") != words.end()) {
    nlohmann::ordered_json json{{"version", FJR_VERSION},
                                {"status", exit_code == 2 ? name(fjr::PlanStatus::kBadInput) : fjr::kFailedStatus},
                                {"reason", problem},
                                {"field", nullptr}};
    if (!field.empty()) json["field"] = field;
    fmt::print("{}", fjr::json_text(json));
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  hold_blas_to_one_thread();
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  try {
    return run(words, argv);
  } catch (const fjr::InputError& error) {
    return complain(words, error.what(), error.field(), 2);
  } catch (const std::exception& error) {
    return complain(words, error.what(), "", 1);
  } catch (...) {
    return complain(words, "unexpected error", "", 1);
  }
}
