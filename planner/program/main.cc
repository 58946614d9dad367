// fjr: the command line.
#include <dlfcn.h>
#include <fcntl.h>
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
#include <system_error>
#include <vector>

#include "common/input_error.h"
#include "common/say.h"
#include "planner/batch/statuses.h"
#include "planner/program/commands.h"
#include "planner/program/misspelt.h"
#include "planner/results/plan_json.h"

namespace {

constexpr const char* kFooter =
    "Exit codes: 0 certified, 2 bad input, 3 infeasible or not converged, 4 certificate failed,\n"
    "            5 deadline or cancelled, 1 anything else; of several plans the largest.";

// Calls a function of a library if it is loaded, and ignores what it returns.
template <class Function, class... Arguments>
void call_if_loaded(const char* name, Arguments... arguments) {
  void* const function = dlsym(RTLD_DEFAULT, name);
  if (function != nullptr) (void)reinterpret_cast<Function*>(function)(arguments...);
}

// Limits the BLAS to one thread, because only then are plans reproducible to the last bit and not slowed down by idle
// BLAS threads. The BLAS is whatever the system has linked Ipopt to. A threaded OpenBLAS has read its environment
// before main() starts, so it is set through its own functions, which other libraries do not have. By then it has also
// started a thread for every core, each of which keeps its core busy for a tenth of a second before it sleeps: they are
// ended, as OpenBLAS itself does before each fork().
void hold_blas_to_one_thread() {
  call_if_loaded<void(int)>("openblas_set_num_threads", 1);
  call_if_loaded<int()>("blas_thread_shutdown_");
}

// Opens the standard streams that are closed, such that reading and writing fails, because otherwise a file that is
// opened later would become stdin, stdout or stderr.
void keep_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    const bool writes = stream != STDIN_FILENO;
    if (::fcntl(stream, F_GETFD) == -1) (void)::open("/dev/null", writes ? O_RDONLY : O_WRONLY);
  }
}

// Replaces this process by the complete executable for --help and for subcommands that are not for planning. If that is
// missing, --help lists the commands of this one.
void hand_over(CLI::App& app, const std::vector<std::string>& words, char** argv) {
  const std::string first = words.empty() ? "" : words.front();
  const auto has_name = [&first](const CLI::App* command) { return command->check_name(first); };
  if (first == "--version" || !app.get_subcommands(has_name).empty()) return;
  const std::filesystem::path complete = fjr::complete_program();
  if (complete.empty()) return;
  std::error_code error;
  const bool is_this_one = std::filesystem::equivalent(complete, "/proc/self/exe", error);
  if (!is_this_one) ::execv(complete.c_str(), argv);
  const std::string missing = fmt::format("the other commands are in {}, which cannot be started ({})",
                                          complete.string(), is_this_one ? "it is this one" : std::strerror(errno));
  app.footer(app.get_footer() + "\n" + missing);
  if (!words.empty() && !first.starts_with('-')) throw std::runtime_error(missing);
}

void check_stdout() {
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) throw std::runtime_error("cannot write to stdout");
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
    if (error.get_exit_code() == 0) {
      exit_code = app.exit(error);
      check_stdout();
      return exit_code;
    }
    throw fjr::InputError("command line", "", fjr::refusal(app, words, error.what()) + " (see --help)");
  }
  check_stdout();
  return exit_code;
}

bool asks_for_json(const std::vector<std::string>& words) {
  const auto options_end = std::find(words.begin(), words.end(), "--");
  return std::any_of(words.begin(), options_end,
                     [](const std::string& word) { return word == "--json" || word == "--json=true"; });
}

// Reports an error, in JSON too if the command line asks for JSON; commands print theirs only at the end. If it cannot
// be written, it is lost.
int complain(const std::vector<std::string>& words, const std::string& problem, const std::string& field,
             int exit_code) {
  fjr::say("fjr: {}\n", problem);
  if (asks_for_json(words)) {
    nlohmann::ordered_json json{{"version", FJR_VERSION},
                                {"status", exit_code == 2 ? name(fjr::PlanStatus::kBadInput) : fjr::kFailedStatus},
                                {"reason", problem},
                                {"field", nullptr}};
    if (!field.empty()) json["field"] = field;
    fjr::say_in(stdout, "{}", fjr::json_text(json));
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  keep_standard_streams();
  hold_blas_to_one_thread();
  const std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  try {
    return run(words, argv);
  } catch (const fjr::InputError& error) {
    return complain(words, error.what(), error.field(), 2);
  } catch (const std::filesystem::filesystem_error& error) {  // whose what() is for programmers
    const std::string path = error.path1().string();
    return complain(words, path.empty() ? error.what() : path + ": " + error.code().message(), "", 1);
  } catch (const std::exception& error) {
    return complain(words, error.what(), "", 1);
  } catch (...) {
    return complain(words, "unexpected error", "", 1);
  }
}
