# Freezes Sixflip into a MicroPython firmware: FROZEN_MANIFEST=…/manifest.py (the board then
# needs a main.py of two lines: from sixflip_device import power_up; power_up.main()).
package("sixflip", base_path="shared")  # noqa: F821
package("sixflip_device", base_path="device")  # noqa: F821
