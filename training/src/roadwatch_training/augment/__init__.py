"""Pictures made to vary more than the simulator does, so that real ones fall within what was seen."""
