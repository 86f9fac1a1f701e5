"""What every procedure is made of: context, records, motion, prompts."""
