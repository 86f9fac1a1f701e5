"""Remote inputs and outputs: door interlock and stack light."""
