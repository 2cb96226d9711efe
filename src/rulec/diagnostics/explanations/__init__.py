"""What each code means: registered here, stage by stage, with an example and the mended one."""
