"""The plugin for napari: a reader, a widget that draws, and cameras both ways; napari is imported nowhere."""
