"""Numbers of events of forces that are series; events of a law's branch have nonnegative numbers."""

from __future__ import annotations

#: of a power contact (see `power_contacts`): it touches, parts, would begin to pull, presses again
TOUCHES, PARTS, RELEASES, PRESSES_AGAIN = -1, -2, -3, -4
LIFT = -5  #: of friction: a sticky contact begins to pull, or to press again (see `friction`)
POWER_CHANGES = -6  #: of a smooth law: the series goes on with another power (see `smooth`)
CROSSES_LINEAR_RANGE = -7  #: of a damper: its rate enters or leaves the linear range (see `power_dampers`)
