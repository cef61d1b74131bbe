"""What the board runs at power-up. Ctrl-C ends it: only Exception is caught here."""


def main():
    """Finishes a provisioning that was cut off and starts the firmware."""
    try:  # noqa: SIM105 - MicroPython has no contextlib
        import sixflip_update  # noqa: F401 - a provisioning that was cut off, see provision.py
    except ImportError:
        pass  # as mostly: there is no such file
    from sixflip_device import power_up
    power_up.main()


try:
    main()
except Exception as e:  # noqa: BLE001 - the last resort: say it, leave the board usable
    import sys
    print('{"event": "error", "what": "the firmware stopped: %s", "expected": "a report"}'
          % repr(e).replace("\\", "/").replace('"', "'"))
    if hasattr(sys, "print_exception"):
        sys.print_exception(e)
    else:
        sys.excepthook(type(e), e, e.__traceback__)
