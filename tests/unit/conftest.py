"""How Hypothesis tries examples in the unit tests."""

import hypothesis

# A busy machine is slow; that is no fault of what is tested.
hypothesis.settings.register_profile(
    "catseye", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.load_profile("catseye")
