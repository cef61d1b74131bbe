"""Studies beside the sealed cases: nulls on real recorded noise, effects taken out of the
library, ambiguities resolved by the capture recommended, and real recordings unattended."""
