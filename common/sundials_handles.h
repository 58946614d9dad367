// RAII for SUNDIALS objects, and checks of return flags, for the rollouts and the virtual rig.
#pragma once

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#if SUNDIALS_VERSION_MAJOR >= 7  // it deprecates the only names that functions have in version 6, of Debian 12
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"
#endif

namespace fjr::sundials {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Throws Error naming the call when its return flag is negative; returns the flag.
inline int check(int flag, const char* call) {
  if (flag >= 0) return flag;
  throw Error(std::string(call) + " returned " + std::to_string(flag));
}

template <class T>
T* check(T* handle, const char* call) {
  if (handle == nullptr) throw Error(std::string(call) + " gave no object");
  return handle;
}

template <auto Free>
struct Release {
  template <class T>
  void operator()(T* handle) const {
    Free(handle);
  }
};

template <class Pointer, auto Free>
using Handle = std::unique_ptr<std::remove_pointer_t<Pointer>, Release<Free>>;

inline void free_context(SUNContext c) { SUNContext_Free(&c); }
inline void free_arkode(void* m) { ARKStepFree(&m); }
inline void free_cvode(void* m) { CVodeFree(&m); }

using Context = Handle<SUNContext, free_context>;
using Vector = Handle<N_Vector, N_VDestroy>;
using Matrix = Handle<SUNMatrix, SUNMatDestroy>;
using LinearSolver = Handle<SUNLinearSolver, SUNLinSolFree>;
using NonlinearSolver = Handle<SUNNonlinearSolver, SUNNonlinSolFree>;
using Arkode = Handle<void*, free_arkode>;
using Cvode = Handle<void*, free_cvode>;

// The differences between versions 6 and 7. Version 7 has the error handlers in the context, and a separate type for
// communicators. Error messages are switched off, because all return flags are checked.
#if SUNDIALS_VERSION_MAJOR >= 7
inline Context make_context() {
  SUNContext c = nullptr;
  check(SUNContext_Create(SUN_COMM_NULL, &c), "SUNContext_Create");
  Context context(c);
  check(SUNContext_ClearErrHandlers(c), "SUNContext_ClearErrHandlers");
  return context;
}
// Sets the convergence coefficient of the implicit stages. With its own coefficient, version 7 ends their iterations
// earlier, and an arm held at rest with the accuracy of ticks deviated by 2.0e-5 rad.
inline void prepare_arkode(void* m) { check(ARKStepSetNonlinConvCoef(m, 1e-2), "ARKStepSetNonlinConvCoef"); }
inline void prepare_cvode(void*) {}
#else
inline Context make_context() {
  SUNContext c = nullptr;
  check(SUNContext_Create(nullptr, &c), "SUNContext_Create");
  return Context(c);
}
inline void ignore_message(int, const char*, const char*, char*, void*) {}
inline void prepare_arkode(void* m) {
  check(ARKStepSetErrHandlerFn(m, ignore_message, nullptr), "ARKStepSetErrHandlerFn");
}
inline void prepare_cvode(void* m) { check(CVodeSetErrHandlerFn(m, ignore_message, nullptr), "CVodeSetErrHandlerFn"); }
#endif

}  // namespace fjr::sundials
