"""An independent generator of captures: physics and CAPTURE.md only, nothing of the product.

It shares no code with simulator, diagnosis or firmware (a test proves it), and gives the known
effects other functional forms than the obvious regressors.
Inside: g for specific force, deg/s for rates, seconds, degrees Celsius.
"""
