"""The volumes of `wavesplat.examples` that the viewer offers, with names for people."""

#: Name of the function -> the name that people read.
EXAMPLES = {"ct_pelvis": "Pelvis, CT", "mri_head": "Head, MRI", "ripples": "Ripples, calculated"}
