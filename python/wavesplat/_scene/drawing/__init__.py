"""Drawing of scenes: layers with their looks and volumes, the frame, the report, the cost."""
