"""What rays of tables have more than those of pictures: rounds, homes, results."""
