// Bad data from outside the program.
#pragma once

#include <stdexcept>
#include <string>

namespace fjr {

// One sentence for the person who wrote the input: "request.yaml: goal.q[1]: 3.4 rad is outside [-2.6, 2.6]".
// Bugs are asserts; hard problems are statuses; only bad input is an InputError.
class InputError : public std::runtime_error {
 public:
  // source: the file or message; field: path of the field within it (may be empty); problem: the value and what is
  // allowed.
  InputError(const std::string& source, const std::string& field, const std::string& problem)
      : std::runtime_error(join(source, field, problem)), source_(source), field_(field), problem_(problem) {}

  const std::string& source() const { return source_; }
  const std::string& field() const { return field_; }
  const std::string& problem() const { return problem_; }

 private:
  static std::string join(const std::string& source, const std::string& field, const std::string& problem) {
    return field.empty() ? source + ": " + problem : source + ": " + field + ": " + problem;
  }

  std::string source_, field_, problem_;
};

}  // namespace fjr
