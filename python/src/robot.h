// fjr.Robot: the parameters of an arm.
#pragma once

#include <string>

#include "model/parameters.h"

namespace fjr::python {

struct Robot {
  Parameters parameters;
  std::string source;  // the file, for people
};

}  // namespace fjr::python
