"""The guided session as a person sees it: a model fed by events, drawings, a terminal screen."""
