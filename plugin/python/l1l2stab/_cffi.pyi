# SPDX-License-Identifier: MIT
# The compiled module, which cffi generates from l1l2stab.h.
from typing import Any

ffi: Any
lib: Any
