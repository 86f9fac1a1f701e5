"""How Hypothesis tries examples in the unit tests."""

import os

import hypothesis

# A busy machine is slow; that is no fault of what is tested.
USUAL = hypothesis.settings(deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow])

# The suite tries the same examples every time: whether a change passes depends on the change, not on luck. What they
# miss is looked for by `make campaign-properties`, with other examples each time.
hypothesis.settings.register_profile("same", USUAL, derandomize=True)
hypothesis.settings.register_profile("fresh", USUAL, derandomize=False, print_blob=True)
hypothesis.settings.load_profile(os.environ.get("CATSEYE_EXAMPLES", "same"))
