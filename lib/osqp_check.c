/* SPDX-License-Identifier: MIT */
/* Compiles only with the OSQP that lib/src/path/qp_osqp.c is written for. Used by meson, not part of the library. */
#include <osqp.h>

_Static_assert(sizeof(c_int) == sizeof(int), "indices are int (DLONG=OFF)");
_Static_assert(sizeof(c_float) == sizeof(double), "numbers are double (DFLOAT=OFF)");

c_int (*setup)(OSQPWorkspace **, const OSQPData *, const OSQPSettings *) = osqp_setup;
