"""How samples look: transfer functions, materials, labels, colours and light."""
