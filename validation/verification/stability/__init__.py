"""Where each method fails, found by running it.

`core` says what a map is, and finds the edge of its stable region and how far inside the default lies; maps.toml holds
the maps; `shots`, `packs`, `cell`, `coupons` and `unit_cell` run a point of each kind of scene; `study`
puts these together; `page` and `pictures` tell what came out.
"""
