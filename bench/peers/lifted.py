"""CasADi functions for Drake: on numbers, and on its AutoDiffXd with CasADi's own Jacobian."""
import casadi as ca
import numpy as np
from pydrake.autodiffutils import ExtractGradient, ExtractValue, InitializeAutoDiff


class Lifted:
    """value as a function of one stacked vector; called through CasADi's buffers, which allocate nothing."""

    def __init__(self, stacked, value):
        outputs = [ca.densify(value), ca.densify(ca.jacobian(value, stacked))]
        self._function = ca.Function("lifted", [stacked], outputs, {"cse": True})
        self._buffer, self._run = self._function.buffer()
        self._in = np.zeros(stacked.numel())
        self._value = np.zeros(value.numel())
        self._jacobian = np.zeros((value.numel(), stacked.numel()), order="F")
        self._buffer.set_arg(0, memoryview(self._in))
        self._buffer.set_res(0, memoryview(self._value))
        self._buffer.set_res(1, memoryview(self._jacobian.T))

    def __call__(self, z):
        if z.dtype != object:
            self._in[:] = z.ravel()
            self._run()
            return self._value.copy()
        self._in[:] = ExtractValue(z).ravel()
        self._run()
        return InitializeAutoDiff(self._value, self._jacobian @ ExtractGradient(z)).ravel()
