// What the module consists of.
#pragma once

#include <nanobind/nanobind.h>

namespace fjr::python {

void add_robot(nanobind::module_& module);
void add_plan(nanobind::module_& module);
void add_client(nanobind::module_& module);
void add_identification(nanobind::module_& module);

}  // namespace fjr::python
