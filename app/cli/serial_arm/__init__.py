"""Commands of serial arms with a tracker, an optical CMM or a ballbar."""
