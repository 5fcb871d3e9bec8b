"""What several commands share: their options, what they print, how they show progress."""
