"""Where each method fails, found by running it: one file a map.

`core` says what a map is, and finds the edge of its stable region and how far inside the default lies; `study` runs the
points; `page` and `pictures` tell what came out.
"""
