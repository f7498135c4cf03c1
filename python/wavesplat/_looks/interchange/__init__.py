"""Looks of other programs: 3D Slicer, ParaView and VTK."""
