// The package's view of the libraries: values in and out, errors as exceptions. What people see is in python/fjr.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <stdexcept>

#include "common/input_error.h"
#include "planner/client/client.h"
#include "python/src/parts.h"

namespace fjr::python {
namespace {

namespace nb = nanobind;

template <class... Arguments>
void raise(const char* name, const Arguments&... arguments) {
  const nb::object type = nb::module_::import_("fjr.errors").attr(name);
  PyErr_SetObject(type.ptr(), nb::make_tuple(arguments...).ptr());
}

void translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise("BadInput", error.source(), error.field(), error.problem());
  } catch (const NoAnswer& silence) {
    raise("NoAnswer", std::string(silence.what()));
  } catch (const nb::builtin_exception&) {  // of nanobind itself, which knows what to make of it
    throw;
  } catch (const nb::python_error&) {
    throw;
  } catch (const std::runtime_error& error) {
    raise("Error", std::string(error.what()));
  }
}

}  // namespace
}  // namespace fjr::python

NB_MODULE(_core, module) {
  nanobind::register_exception_translator(fjr::python::translate);
  fjr::python::add_robot(module);
  fjr::python::add_plan(module);
  fjr::python::add_identification(module);
  fjr::python::add_client(module);
  module.attr("version") = FJR_VERSION;
}
