"""What happens on the bench, step by step: async functions over a context."""
