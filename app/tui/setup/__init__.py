"""Parts of the screen Set-up."""
